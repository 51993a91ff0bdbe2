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
        known: _Plans = memory
        planner = self._planner
        hover = lanes_last(inputs[HOVER], known.lanes)
        goal = lanes_last(inputs[GOAL], known.lanes).float()
        idle = planner.initial_plan(hover)
        plan = idle.clone() if known.plan is None else known.plan
        parts = self._chunks(tuple(_planned(inputs)))
        searches = [planner.init(plan[..., part.rows], hover[part.rows]) for part in parts]
        for iteration in range(planner.iterations):
            candidates = Candidates(
                len(known.batch.scenes),
                parts,
                tuple(
                    planner.propose(search, self._noise(known.batch, part, inputs.step, iteration))
                    for search, part in zip(searches, parts, strict=True)
                ),
            )
            predicted: Predicted = inputs[ROLLOUT](candidates)
            clearance = inputs[CLEARANCE](predicted)
            searches = [
                planner.update(
                    search,
                    Scored(
                        rollout, commands, clearance[part.rows], goal[:, part.rows], search.hover
                    ),
                )
                for search, part, rollout, commands in zip(
                    searches, parts, predicted.rollouts, candidates.commands, strict=True
                )
            ]
        command = idle[0]
        for part, search in zip(parts, searches, strict=True):
            command[:, part.rows] = search.plan[0]
            plan[..., part.rows] = shift(search.plan)
        count = len(known.batch.scenes)
        commanded = command[:, :count].T.double()
        return {"commanded_action": commanded}, _Plans(known.batch, known.lanes, plan)

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
