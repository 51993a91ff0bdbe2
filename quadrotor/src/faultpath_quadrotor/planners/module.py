"""The planner as a module of the loop: it asks where candidates lead, and decides."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial

import torch
from torch import Tensor

from faultpath.loop import Batch, Inputs, Memory, Module, Outputs, Port
from faultpath_quadrotor.batching import Chunk, into_chunks, lanes_last, lanes_of
from faultpath_quadrotor.device import host_readable, send
from faultpath_quadrotor.planners import Planner, Scored, shift
from faultpath_quadrotor.predictors.rollout import Candidates, Predicted

ROLLOUT = Port("rollout", "candidates")
HOVER_THRUST = Port("hover", "reference")
GOAL = Port("goal", "goal_cost")
CLEARANCE = Port("clearance", "risk_cost")


@dataclass(frozen=True)
class _Plans:
    """Plan that the planner keeps between steps."""

    batch: Batch
    lanes: Tensor
    plan: Tensor | None = None
    """`[H, 4, L]`: where the next step's search starts."""


class PlannerModule(Module):
    """Plans for the scenes that still run, some of them at a time."""

    name, writes = "planner", ("commanded_action",)
    reads = frozenset({ROLLOUT, HOVER_THRUST, GOAL, CLEARANCE})

    def __init__(
        self,
        planner: Planner,
        device: torch.device,
        hover_command: Callable[[Sequence[str]], Tensor],
    ) -> None:
        """`hover_command` gives the command `[B, 4]` under which the scenes' vehicles hover."""
        self._planner = planner
        self._device = device
        self._hover_command = hover_command
        self._chunks = lru_cache(maxsize=2)(partial(into_chunks, device=device))

    def begin(self, batch: Batch) -> Memory:
        """Return a memory without a plan."""
        return _Plans(batch, lanes_of(batch, self._device))

    def before(self, batch: Batch) -> Outputs:
        """Return the command that was executed before the flight: the vehicles hovered."""
        return {"commanded_action": self._hover_command(batch.scenes).to(self._device)}

    def noise_hashes(self, batch: Batch) -> tuple[str, ...]:
        """Return, for each scene, a hash of the noise that its first replan drew."""
        drawn = (self._planner.noise([scene], batch.seed, 0) for scene in batch.scenes)
        return tuple(hashlib.sha256(noise.numpy().tobytes()).hexdigest()[:16] for noise in drawn)

    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Return the command, `[B, 4]`, N and rad/s; scenes that do not run get the hover."""
        plans: _Plans = memory
        batch, planner = plans.batch, self._planner
        hover_thrust = lanes_last(inputs[HOVER_THRUST], plans.lanes)
        goal = lanes_last(inputs[GOAL], plans.lanes).float()
        hovering = planner.initial_plan(hover_thrust)
        plan = hovering if plans.plan is None else plans.plan
        command = hovering[0].clone()

        # Start, then sample, score and update as often as the planner asks, then finish.
        chunks = self._chunks(tuple(_planned(inputs)))
        searches = [planner.init(plan[..., c.rows], hover_thrust[c.rows]) for c in chunks]
        for iteration in range(planner.iterations):
            noise = (self._noise(batch, chunk, inputs.step, iteration) for chunk in chunks)
            commands = tuple(map(planner.propose, searches, noise))
            predicted: Predicted = inputs[ROLLOUT](Candidates(len(batch.scenes), chunks, commands))
            clearance = inputs[CLEARANCE](predicted)
            scored = (
                Scored(rollout, drawn, clearance[chunk.rows], goal[:, chunk.rows], search.hover)
                for chunk, search, rollout, drawn in zip(
                    chunks, searches, predicted.rollouts, commands, strict=True
                )
            )
            searches = list(map(planner.update, searches, scored))
        for chunk, search in zip(chunks, searches, strict=True):
            command[:, chunk.rows] = search.plan[0]
            plan[..., chunk.rows] = shift(search.plan)
        commanded = command[:, : len(batch.scenes)].T.double()
        return {"commanded_action": commanded}, _Plans(batch, plans.lanes, plan)

    def _noise(self, batch: Batch, chunk: Chunk, step: int, iteration: int) -> Tensor:
        scenes = [batch.scenes[i] for i in chunk.scenes]
        drawn = self._planner.noise(scenes, batch.seed, step, iteration)
        return send(drawn, chunk.index.device)


def _planned(inputs: Inputs) -> Sequence[int]:
    """Return the scenes to plan for.

    Only the device knows which trials run there. All scenes are planned, and a scene's plan no
    longer counts once its trial has ended.
    """
    running = inputs.running
    if host_readable(running.device):
        return running.nonzero()[:, 0].tolist()
    return range(len(running))
