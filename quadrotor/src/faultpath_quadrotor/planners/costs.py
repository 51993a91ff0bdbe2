"""Cost that the planner minimises: goal, clearance risk, speed, heading and effort."""

import ctypes
from dataclasses import dataclass

import torch
from pydantic import Field
from torch import Tensor

from faultpath.plugin.system import Frozen
from faultpath_quadrotor import native
from faultpath_quadrotor.native.kernel_args import Block, covered, fields, lend, output
from faultpath_quadrotor.predictors.rollout import Rollout
from faultpath_quadrotor.vehicle import COLLISION_RADIUS_M


class CostWeights(Frozen):
    """Weights of the terms, per replan. Goal, risk and speed are the paper's terms.

    The values were matched on the selection library (`docs/design/platform.md`).
    """

    goal: float = 8.0
    running: float = Field(default=0.4, ge=0, le=1)
    """Share of the mean distance along the horizon in the distance to the goal; the rest is that at
    its end. At 0 the planner is soft in height: a candidate that climbs back by the end pays
    nothing for the way, so a thrust error settles into an altitude offset. At 1 it is stiff."""
    risk: float = 36.0
    hit: float = 400.0
    margin_m: float = 0.3
    """Clearance beyond the collision radius below which risk starts."""
    speed: float = 20.0
    v_max_mps: float = 3.4  # paper, Table I
    heading: float = 0.5
    rate_effort: float = 0.4
    thrust_effort: float = 12.0
    """On the squared departure from hover thrust, as a fraction of it: the control cost of MPPI."""


@dataclass(frozen=True)
class Scored:
    """Everything that a cost may depend on, batch `[S, K]`."""

    rollout: Rollout
    commands: Tensor
    """`[H, 4, S, K]`."""
    clearance: Tensor
    """Clearance of the vehicle's centre along the rollout, `[S, H, K]`, metres."""
    goal: Tensor
    """`[3, S]`, metres, world frame."""
    hover: Tensor
    """Thrust that the predictor believes holds the vehicle, `[S]`, N."""


def _norm(vector: Tensor) -> Tensor:
    return vector.square().sum(0).sqrt_()


class NavigationCost:
    """The weighted sum of all terms."""

    def __init__(self, weights: CostWeights | None = None) -> None:
        self.weights = weights or CostWeights()

    def __call__(self, scored: Scored) -> Tensor:
        """Return the cost `[S, K]`."""
        compiled = self._compiled(scored)  # None: no kernel for this call
        return self.reference(scored) if compiled is None else compiled

    def reference(self, scored: Scored) -> Tensor:
        """Return the cost `[S, K]` by its formula, which the kernel repeats to rounding."""
        w, rollout = self.weights, scored.rollout
        at_end = _norm(rollout.final.position - scored.goal[..., None])
        on_way = _norm(rollout.positions - scored.goal[..., None, None]).mean(1)
        free = scored.clearance - COLLISION_RADIUS_M
        close = (1 - free / w.margin_m).clamp_(0, 1).square_().mean(1)
        hits = (free < 0).to(free.dtype).mean(1)
        too_fast = (_norm(rollout.velocities) - w.v_max_mps).clamp_(min=0).square_().mean(1)
        turning = scored.commands[:, 1:].square().sum(1).mean(0)
        hover = scored.hover[:, None]
        pushing = (scored.commands[:, 0] - hover).square_().mean(0) / hover.square()

        goal = torch.lerp(at_end, on_way, w.running).mul_(w.goal)
        risk = close.mul_(w.risk).add_(hits, alpha=w.hit)
        speed = too_fast.mul_(w.speed)
        heading = self._heading(scored).mul_(w.heading)
        effort = turning.mul_(w.rate_effort)
        # In this order, the last in one step: it decides the last bits.
        return (goal + risk + speed + heading + effort).add_(pushing, alpha=w.thrust_effort)

    def _heading(self, scored: Scored) -> Tensor:
        """One minus the cosine between the body's x axis and the direction of travel, seen from
        above, at the end of the horizon: yaw follows the direction of travel."""
        final = scored.rollout.final
        forward, travel = final.rotation[:2, 0], final.velocity[:2]
        along = (forward * travel).sum(0)
        scale = (forward.square().sum(0) * travel.square().sum(0)).add_(1e-4).rsqrt_()
        return torch.addcmul(torch.ones_like(along), along, scale, value=-1)

    def _compiled(self, scored: Scored) -> Tensor | None:
        rollout, commands = scored.rollout, scored.commands
        steps, _, scenes, count = commands.shape
        moved = (3, scenes, steps, count)
        inputs = {
            "positions": (rollout.positions, moved),
            "velocities": (rollout.velocities, moved),
            "rotation": (rollout.final.rotation, (3, 3, scenes, count)),
            "commands": (commands, commands.shape),
            "clearance": (scored.clearance, moved[1:]),
            "goal": (scored.goal, (3, scenes)),
            "hover": (scored.hover, (scenes,)),
        }
        built = native.kernels_for(*(value for value, _ in inputs.values()))
        if built is None or not (steps and native.whole_vectors(count)):
            return None
        if not (covered(self, NavigationCost) and covered(self.weights, CostWeights)):
            return None
        costs = output(scenes, count)
        built.call(
            "faultpath_cost",
            _Weights(radius_m=COLLISION_RADIUS_M, **self.weights.model_dump()),
            *(lend(name, value, *shape) for name, (value, shape) in inputs.items()),
            *(steps, scenes, count, costs),
        )
        return costs.tensor


class _Weights(Block):
    """`Weights` of `costs.cpp`."""

    _fields_ = fields(
        ctypes.c_float,
        "running goal risk hit margin_m radius_m speed v_max_mps heading rate_effort thrust_effort",
    )
