"""One step of the planner outside the loop, as both planning comparisons time it."""

from collections.abc import Callable, Sequence

from torch import Tensor

from faultpath.quadrotor.planner import Planner, Scored, shift
from faultpath.quadrotor.predictors import PredictorInputs
from faultpath.quadrotor.rollout import Roll
from faultpath.quadrotor.vehicle import GRAVITY_MPS2


def replan(
    planner: Planner,
    roll: Roll,
    inputs: PredictorInputs,
    plan: Tensor,
    goal: Tensor,
    scenes: Sequence[str],
    step: int,
    clearance: Callable[[Tensor], Tensor],
) -> Tensor:
    """Return the next step's warm start `[H, 4, S]`, from `plan`.

    `clearance` gives `[S, H, K]`, metres, along positions `[3, S, H, K]`.
    """
    hover = inputs.trim.hover_thrust(GRAVITY_MPS2)[:, 0]
    search = planner.init(plan, hover)
    for iteration in range(planner.iterations):
        commands = planner.propose(search, planner.noise(scenes, 0, step, iteration))
        rollout = roll(inputs, commands)
        near = clearance(rollout.positions)
        search = planner.update(search, Scored(rollout, commands, near, goal, hover))
    return shift(search.plan)
