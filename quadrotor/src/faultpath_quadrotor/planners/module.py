"""The planner as a module of the loop: it asks where candidates lead, and decides."""

import hashlib
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache, partial

import torch
from torch import Tensor

from faultpath.loop import Batch, Inputs, Memory, Module, Outputs, Port
from faultpath_quadrotor.batching import Chunk, into_chunks
from faultpath_quadrotor.device import host_readable, send
from faultpath_quadrotor.planners.base import Planner, Search, shift
from faultpath_quadrotor.planners.costs import Scored
from faultpath_quadrotor.predictors.rollout import Candidates, Predicted

ROLLOUT = Port("rollout", "candidates")
HOVER_THRUST = Port("hover", "reference")
GOAL = Port("goal", "goal_cost")
CLEARANCE = Port("clearance", "risk_cost")

Chunks = Sequence[Chunk]


class PlannerModule(Module):
    """Plans for the scenes that still run, some of them at a time.

    What it remembers is the batch and the plan `[H, 4, B]` where the next step's search starts.
    """

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
        return batch, None

    def before(self, batch: Batch) -> Outputs:
        """Return the command that was executed before the flight: the vehicles hovered."""
        return {"commanded_action": self._hover_command(batch.scenes).to(self._device)}

    def noise_hashes(self, batch: Batch) -> tuple[str, ...]:
        """Return, for each scene, a hash of the noise that its first replan drew."""
        drawn = (self._planner.noise([scene], batch.seed, 0) for scene in batch.scenes)
        return tuple(hashlib.sha256(noise.numpy().tobytes()).hexdigest()[:16] for noise in drawn)

    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Return the command, `[B, 4]`, N and rad/s; scenes that do not run get the hover."""
        planner, (batch, plan) = self._planner, memory
        hover: Tensor = inputs[HOVER_THRUST]
        hovering = planner.initial_plan(hover)
        plan = hovering.clone() if plan is None else plan
        # Only the device knows which trials run there: it plans for all, and a scene's plan no
        # longer counts once its trial has ended.
        running, everyone = inputs.running, range(len(inputs.running))
        known = host_readable(running.device)
        chunks = self._chunks(tuple(running.nonzero()[:, 0].tolist() if known else everyone))

        searches = [planner.init(plan[..., c.rows], hover[c.rows]) for c in chunks]
        for iteration in range(planner.iterations):
            noise = self._noise(batch, chunks, inputs.step, iteration)
            commands = tuple(map(planner.propose, searches, noise))
            scored = _scored(inputs, chunks, searches, commands)
            searches = list(map(planner.update, searches, scored))

        command = hovering[0]
        for chunk, search in zip(chunks, searches, strict=True):
            command[:, chunk.rows] = search.plan[0]
            plan[..., chunk.rows] = shift(search.plan)
        return {"commanded_action": command.T.double()}, (batch, plan)

    def _noise(self, batch: Batch, chunks: Chunks, step: int, iteration: int) -> Iterator[Tensor]:
        for chunk in chunks:
            scenes = [batch.scenes[i] for i in chunk.scenes]
            yield send(self._planner.noise(scenes, batch.seed, step, iteration), chunk.index.device)


def _scored(
    inputs: Inputs, chunks: Chunks, searches: Sequence[Search], commands: tuple[Tensor, ...]
) -> Iterator[Scored]:
    """Ask the predictor where commands lead, and the clearance along the way; yield both."""
    goal = inputs[GOAL].T.float()
    predicted: Predicted = inputs[ROLLOUT](Candidates(goal.shape[1], tuple(chunks), commands))
    clearance = inputs[CLEARANCE](predicted)
    parts = zip(chunks, searches, predicted.rollouts, commands, strict=True)
    for chunk, search, rollout, drawn in parts:
        yield Scored(rollout, drawn, clearance[chunk.rows], goal[:, chunk.rows], search.hover)
