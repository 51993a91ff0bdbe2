"""The planner as a module of the loop: it asks where candidates lead, and decides."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial

import torch
from torch import Tensor

from faultpath.loop import Batch, Inputs, Memory, Module, Outputs, Port
from faultpath_quadrotor.batching import Chunk, chunks, lanes_last, lanes_of
from faultpath_quadrotor.device import host_readable, send
from faultpath_quadrotor.planners import Planner, Scored, shift
from faultpath_quadrotor.predictors.rollout import Candidates, Predicted

ROLLOUT = Port("rollout", "candidates")
HOVER = Port("hover", "reference")
GOAL = Port("goal", "goal_cost")
CLEARANCE = Port("clearance", "risk_cost")


@dataclass(frozen=True)
class _Plans:
    """Plan that the planner keeps between steps."""

    batch: Batch
    lanes: Tensor
    plan: Tensor | None = None
    """`[H, 4, L]`: where the next step's search starts."""


class Planning(Module):
    """Plans for the scenes that still run, some of them at a time."""

    name, writes = "planner", ("commanded_action",)
    reads = frozenset({ROLLOUT, HOVER, GOAL, CLEARANCE})

    def __init__(
        self, planner: Planner, device: torch.device, hover: Callable[[Sequence[str]], Tensor]
    ) -> None:
        """`hover` gives the command `[B, 4]` under which the scenes' vehicles hover."""
        self._planner = planner
        self._device = device
        self._hover = hover
        self._chunks = lru_cache(maxsize=2)(partial(chunks, device=device))

    def begin(self, batch: Batch) -> Memory:
        """Return a memory without a plan."""
        return _Plans(batch, lanes_of(batch, self._device))

    def before(self, batch: Batch) -> Outputs:
        """Return the command that was executed before the flight: the vehicles hovered."""
        return {"commanded_action": self._hover(batch.scenes).to(self._device)}

    def noise_hashes(self, batch: Batch) -> tuple[str, ...]:
        """Return, for each scene, a hash of the noise that its first replan drew."""
        return tuple(
            hashlib.sha256(
                self._planner.noise([scene], batch.seed, 0).numpy().tobytes()
            ).hexdigest()[:16]
            for scene in batch.scenes
        )

    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Return the command, `[B, 4]`, N and rad/s; scenes that do not run get the hover."""
        plans: _Plans = memory
        batch, planner = plans.batch, self._planner
        hover = lanes_last(inputs[HOVER], plans.lanes)
        goal = lanes_last(inputs[GOAL], plans.lanes).float()
        idle = planner.initial_plan(hover)
        plan = idle.clone() if plans.plan is None else plans.plan
        parts = self._chunks(tuple(_planned(inputs)))
        searches = [planner.init(plan[..., part.rows], hover[part.rows]) for part in parts]
        for iteration in range(planner.iterations):
            noise = (self._noise(batch, part, inputs.step, iteration) for part in parts)
            commands = tuple(map(planner.propose, searches, noise))
            predicted: Predicted = inputs[ROLLOUT](Candidates(len(batch.scenes), parts, commands))
            clearance = inputs[CLEARANCE](predicted)
            scored = [
                Scored(rollout, drawn, clearance[part.rows], goal[:, part.rows], search.hover)
                for part, search, rollout, drawn in zip(
                    parts, searches, predicted.rollouts, commands, strict=True
                )
            ]
            searches = list(map(planner.update, searches, scored))
        command = idle[0]
        for part, search in zip(parts, searches, strict=True):
            command[:, part.rows] = search.plan[0]
            plan[..., part.rows] = shift(search.plan)
        commanded = command[:, : len(batch.scenes)].T.double()
        return {"commanded_action": commanded}, _Plans(batch, plans.lanes, plan)

    def _noise(self, batch: Batch, part: Chunk, step: int, iteration: int) -> Tensor:
        scenes = [batch.scenes[i] for i in part.scenes]
        drawn = self._planner.noise(scenes, batch.seed, step, iteration)
        return send(drawn, part.index.device)


def _planned(inputs: Inputs) -> Sequence[int]:
    """Return the scenes to plan for.

    Only the device knows which trials run there. All scenes are planned, and a scene's plan no
    longer counts once its trial has ended.
    """
    running = inputs.running
    if host_readable(running.device):
        return running.nonzero()[:, 0].tolist()
    return range(len(running))
