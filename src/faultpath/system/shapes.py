"""Shapes of sources, from the first step of a loop."""

from typing import Any, cast

import numpy as np

from faultpath.loop import Batch, Loop, Reading
from faultpath.system.episodes import SCENE


def first_shapes(loop: Loop, dt_s: float) -> dict[str, tuple[int, ...]]:
    """Return the shape of one scene's reading of each source that is read at the first step."""
    recorder = _Recorder()
    first = next(iter(loop.execute(Batch((f"{SCENE}0",), 0, dt_s), cast("Any", recorder))))
    for world in first.state.worlds:
        world.close()
    return recorder.shapes


class _Recorder:
    """Stands in for the taps."""

    def __init__(self) -> None:
        self.shapes: dict[str, tuple[int, ...]] = {}

    def set_active(self, mask: Any) -> None:
        del mask

    def deliver(
        self, channel: str, reader: str, reading: Reading, step: int, scene: int | None = None
    ) -> Any:
        del channel, reader, step, scene
        if hasattr(reading.value, "shape"):
            self.shapes.setdefault(reading.source, tuple(np.shape(reading.value)[1:]))
        return reading.value
