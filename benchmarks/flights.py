"""A real block in flight: how much of a closed-loop replan is not the rollout."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from functools import wraps
from itertools import islice
from typing import Any

from faultpath.loop import Batch, Instant
from faultpath.quadrotor.perception import DepthClearance, DepthRenderer
from faultpath.quadrotor.perception.module import Perception
from faultpath.quadrotor.planners import MPPI, AutoregressiveSampler
from faultpath.quadrotor.plant.world import World
from faultpath.quadrotor.predictors import AnchoredPredictor
from faultpath.quadrotor.predictors.horizon import HorizonLoop
from faultpath.quadrotor.reconstruction.module import WindReconstruction
from faultpath.quadrotor.scenes.field import DistanceField
from faultpath.quadrotor.system import Quadrotor
from faultpath.taps import Taps
from faultpath.trials import SystemSpec, load_system

SCENES = 50
STEPS = 20
VARIANT = "gru"
WHOLE = "whole"

PARTS: Mapping[str, tuple[tuple[Any, str], ...]] = {
    "rendering": ((DepthRenderer, "render"),),
    "encoding": ((Perception, "step"),),
    "noise": ((AutoregressiveSampler, "noise"),),
    "candidates": ((MPPI, "propose"),),
    "rollout": ((HorizonLoop, "__call__"), (AnchoredPredictor, "step")),
    "clearance queries": ((DepthClearance, "query"), (DistanceField, "query")),
    "costs and update": ((MPPI, "update"),),
    "plant and contact": ((World, "advance"),),
    "history code": ((AnchoredPredictor, "encode"),),
    "wind reconstruction": ((WindReconstruction, "step"),),
}
"""The methods in which the parts of a control step are; the rest is taps and bookkeeping."""


class ClosedLoop:
    """A side: twenty control steps of a block; the unit is one running scene's step."""

    def __init__(self, clearance: str = "true", scenes: int = SCENES, repeats: int = 3) -> None:
        options = {"wind": "L3", "predictor": "wm-a-wind", "clearance": clearance}
        system = load_system(SystemSpec(name="quadrotor", options=options))
        assert isinstance(system, Quadrotor)
        self._system = system
        self._scenes = tuple(scene.id for scene in system.library("selection").scenes[:scenes])
        self._steps: Iterator[Instant] = iter(())
        self._repeats = repeats
        self.amount = 0

    def prepare(self) -> None:
        """Fly a new block up to its first command."""
        system, parts = self._system, self._system.variants[VARIANT]
        taps = Taps(
            system.interface,
            (),
            scenes=self._scenes,
            dt_s=system.control_dt_s,
            seed=0,
            bindings=parts.bindings,
            consumers=parts.consumers,
            privileged=parts.privileged,
        )
        batch = Batch(self._scenes, 0, system.control_dt_s)
        self._steps = system.loop(VARIANT, 0).execute(batch, taps)
        next(self._steps)

    def work(self) -> None:
        """Fly on; counts the steps of scenes that still run."""
        worlds: Iterator[World] = (now.state.world for now in islice(self._steps, STEPS))
        count = len(self._scenes)
        self.amount = sum(int(world.progress.running[:count].sum()) for world in worlds)

    def answer(self) -> Sequence[float]:
        """Return the time of each of `PARTS` and of the whole, s a running scene's step."""
        return list(self.spent(self._repeats).values())

    def spent(self, repeats: int) -> dict[str, float]:
        """Return the time of each of `PARTS` and of the `WHOLE`, s a running scene's step."""
        spent, replans = dict.fromkeys((*PARTS, WHOLE), 0.0), 0.0
        for _ in range(repeats):
            self.prepare()
            with ExitStack() as stack:
                for part, methods in PARTS.items():
                    for owner, method in methods:
                        clocked = _clocked(getattr(owner, method), spent, part)
                        stack.enter_context(replaced(owner, method, clocked))
                _clocked(self.work, spent, WHOLE)()
            replans += self.amount
        return {part: seconds / replans for part, seconds in spent.items()}


def _clocked(original: Callable[..., Any], spent: dict[str, float], part: str) -> Any:
    @wraps(original)
    def timed(*arguments: Any, **named: Any) -> Any:
        start = time.process_time()
        try:
            return original(*arguments, **named)
        finally:
            spent[part] += time.process_time() - start

    return timed


@contextmanager
def replaced(owner: Any, name: str, by: Callable[..., Any]) -> Iterator[None]:
    """Let another function stand in a function's place while the context lasts."""
    original = getattr(owner, name)
    setattr(owner, name, by)
    try:
        yield
    finally:
        setattr(owner, name, original)
