"""Counts of steps, scene by scene, kept where the readings live."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from faultpath.core.arrays import Array, namespace, place, to_numpy, together


class Tally:
    """Steps at which something held in a scene.

    Counts stay on the device of the masks, so that counting costs no host wait. Several taps may
    report the same step; it counts once.
    """

    __slots__ = ("_done", "_pending", "_step")

    def __init__(self) -> None:
        self._done: Any = 0
        self._pending: Any = False
        self._step = -1

    def note(self, step: int, held: Any) -> None:
        """Report that the bool or boolean array `[B]` `held` at `step`."""
        if step != self._step:
            self._done, self._pending, self._step = self._total(), held, step
        elif self._pending is False:
            self._pending = held
        elif held is not False:
            one, other = together(self._pending, held)
            self._pending = one | other

    def _total(self) -> Any:
        if self._pending is False:
            return self._done
        done, pending = together(self._done, self._pending)
        return done + pending

    def counts(self, n_scenes: int) -> NDArray[np.int64]:
        """Return the counts `[B]`; this waits for the device."""
        total = to_numpy(self._total()).astype(np.int64)
        return np.broadcast_to(total, (n_scenes,)).copy()


class Running:
    """Which scenes are still running, at hand on the device of any reading."""

    __slots__ = ("_mask", "_placed")

    def __init__(self, mask: Array | None) -> None:
        self._mask = mask
        self._placed: Array = mask

    def among(self, held: Any, reading: Array) -> Any:
        """Return `held`, a bool or boolean array `[B]`, where the scene runs."""
        if self._mask is None or held is False:
            return held
        placed = self._placed
        if namespace(placed) is not namespace(reading) or placed.device != reading.device:
            placed = self._placed = place(to_numpy(self._mask), reading)
        return placed if held is True else held & placed
