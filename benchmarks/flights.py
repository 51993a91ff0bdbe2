"""A real block in flight: how much of a closed-loop replan is not the rollout."""

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any

import torch
from typing_extensions import override

from benchmarks.side import Side
from faultpath.loop import Batch, Instant
from faultpath.quadrotor.modules.clearance import Perception
from faultpath.quadrotor.modules.wind import WindReconstruction
from faultpath.quadrotor.native.rollout import HorizonLoop
from faultpath.quadrotor.perception import DepthClearance, DepthRenderer
from faultpath.quadrotor.planner import MPPI, AutoregressiveSampler
from faultpath.quadrotor.predictors import AnchoredPredictor
from faultpath.quadrotor.scenes.field import DistanceField
from faultpath.quadrotor.system import Quadrotor
from faultpath.quadrotor.world import World
from faultpath.taps import Taps
from faultpath.trials import SystemSpec, load_system

SCENES = 50
STEPS = 20
VARIANT = "gru"

PARTS: dict[str, tuple[tuple[Any, str], ...]] = {
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

WHOLE = "whole"


class ClosedLoop(Side):
    """Twenty control steps of a block; the unit is one running scene's step."""

    def __init__(self, clearance: str = "true", scenes: int = SCENES) -> None:
        torch.set_num_threads(1)
        options = {"wind": "L3", "predictor": "wm-a-wind", "clearance": clearance}
        system = load_system(SystemSpec(name="quadrotor", options=options))
        assert isinstance(system, Quadrotor)
        self._system = system
        self._scenes = [scene.id for scene in system.library("selection").scenes[:scenes]]
        self._steps: Iterator[Instant] = iter(())
        self.amount = 0

    @torch.inference_mode()
    def prepare(self) -> None:
        """Fly a new block up to its first command."""
        system, parts = self._system, self._system.variants[VARIANT]
        taps = Taps(
            system.interface,
            (),
            scenes=tuple(self._scenes),
            dt_s=system.control_dt_s,
            seed=0,
            bindings=parts.bindings,
            consumers=parts.consumers,
            privileged=parts.privileged,
        )
        batch = Batch(tuple(self._scenes), 0, system.control_dt_s)
        self._steps = system.loop(VARIANT, 0).execute(batch, taps)
        next(self._steps)

    @torch.inference_mode()
    @override
    def work(self) -> None:
        replans = 0
        for _ in range(STEPS):
            world: World = next(self._steps).state.world
            replans += int(world.progress.running[: len(self._scenes)].sum())
        self.amount = replans

    def answer(self) -> Sequence[float]:
        """Return the time of each of `PARTS` and of the whole, s a running scene's step."""
        return list(self.spent(repeats=3).values())

    def spent(self, repeats: int) -> dict[str, float]:
        """Return the time of each of `PARTS` and of the `WHOLE`, s a running scene's step."""
        spent, replans = dict.fromkeys((*PARTS, WHOLE), 0.0), 0.0
        for _ in range(repeats):
            self.prepare()
            with ExitStack() as stack:
                for part, methods in PARTS.items():
                    for owner, method in methods:
                        stack.enter_context(_clocked(owner, method, spent, part))
                start = time.process_time()
                self.work()
                spent[WHOLE] += time.process_time() - start
            replans += self.amount
        return {part: seconds / replans for part, seconds in spent.items()}


@contextmanager
def _clocked(owner: type, method: str, spent: dict[str, float], part: str) -> Iterator[None]:
    """Add up the time that calls of a method take, while the context lasts."""
    original = getattr(owner, method)

    def timed(*arguments: Any, **named: Any) -> Any:
        start = time.process_time()
        try:
            return original(*arguments, **named)
        finally:
            spent[part] += time.process_time() - start

    setattr(owner, method, timed)
    try:
        yield
    finally:
        setattr(owner, method, original)
