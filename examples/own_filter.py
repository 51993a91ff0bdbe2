"""An estimator as a user would bring it: gyroscope, specific force and position fixes, filtered."""

import torch
from faultpath_quadrotor.estimators import Estimator
from faultpath_quadrotor.so3 import exp

from faultpath.loop import Port

GYROSCOPE, FORCE, FIX = (
    Port(channel, "filter") for channel in ("gyroscope", "specific_force", "position_fix")
)
DT_S, GRAVITY = 0.05, torch.tensor([0.0, 0.0, -9.81]).double()


class Filter(Estimator):
    """Integrates gyroscope and specific force from the pose at the start, and follows the fixes."""

    reads = frozenset({GYROSCOPE, FORCE, FIX})
    truths = ("vehicle",)

    def step(self, inputs, memory):
        rate, force, fix = inputs[GYROSCOPE], inputs[FORCE], inputs[FIX]
        if memory is None:
            start = inputs.truth("vehicle")
            position, velocity, attitude = fix, start["velocity"], start["attitude"]
        else:
            position, velocity, attitude, old_rate, old_force = memory
            turn = exp(0.5 * DT_S * (old_rate + rate).T).movedim(-1, 0)
            turned = attitude @ turn
            world = 0.5 * (attitude @ old_force[..., None] + turned @ force[..., None])[..., 0]
            ahead = velocity + DT_S * (world + GRAVITY)
            position, attitude = position + 0.5 * DT_S * (velocity + ahead), turned
            missed = fix - position
            position, velocity = position + 0.3 * missed, ahead + 0.6 * missed
        known = dict(zip(self.writes, (position, velocity, attitude, rate), strict=True))
        return known, (position, velocity, attitude, rate, force)


def create(seed):
    return Filter()
