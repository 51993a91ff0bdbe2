"""One replan outside the loop: what tests of planners share."""

from collections.abc import Callable, Sequence

import torch
from faultpath_quadrotor.planners import Planner, Scored, Search
from faultpath_quadrotor.predictors import KinematicIntegrator, PredictorInputs
from faultpath_quadrotor.predictors.base import hover_thrust
from faultpath_quadrotor.predictors.rollout import rolling
from faultpath_quadrotor.vehicle import NOMINAL_DRAG_KGPS
from torch import Tensor


def replan(
    planner: Planner,
    inputs: PredictorInputs,
    plan: Tensor,
    scenes: Sequence[str],
    step: int = 0,
    goal: Tensor | None = None,
    clearance: Callable[[Tensor], Tensor] = lambda positions: torch.ones_like(positions[0]),
    seen: Callable[[Search], object] = lambda search: None,
) -> Tensor:
    """Return the plan that one step makes of `plan`, `[H, 4, S]`.

    `clearance` gives `[S, H, K]` at positions `[3, S, H, K]`, a metre where it is not given; the
    goal `[3, S]` is the origin where it is not. `seen` is called with each search.
    """
    hover = hover_thrust(inputs.delivered, "trim")[:, 0]
    roll = rolling(KinematicIntegrator(drag=True, drag_kgps=NOMINAL_DRAG_KGPS))
    search = planner.init(plan, hover)
    for iteration in range(planner.iterations):
        commands = planner.propose(search, planner.noise(scenes, 0, step, iteration))
        rollout = roll(inputs, commands)
        near = clearance(rollout.positions)
        goals = torch.zeros(3, len(scenes)) if goal is None else goal
        search = planner.update(search, Scored(rollout, commands, near, goals, hover))
        seen(search)
    return search.plan
