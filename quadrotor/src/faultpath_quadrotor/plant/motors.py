"""Four motors in cross configuration: what they exert together, and their first-order lag.

Body frame x forward, y left, z up. Motors, in order: front left, rear left, rear right, front
right; the first and third turn so that their drag torque is positive about body z.
"""

import math

import torch
from torch import Tensor

from faultpath_quadrotor.plant.vehicle_batch import Vehicle
from faultpath_quadrotor.vehicle import ARM_LENGTH_M, TORQUE_COEFFICIENT_M

_ARM = ARM_LENGTH_M * math.sqrt(0.5)
WRENCH_PER_THRUST = (
    (1.0, 1.0, 1.0, 1.0),
    (_ARM, _ARM, -_ARM, -_ARM),  # y of the motors
    (-_ARM, _ARM, _ARM, -_ARM),  # minus x
    tuple(sign * TORQUE_COEFFICIENT_M for sign in (1.0, -1.0, 1.0, -1.0)),
)
"""Collective thrust (N) and body torque (N m) per newton of each motor: 4 x 4 with orthogonal
rows, so its inverse is its transpose over the rows' squared norms."""


def column(values: tuple, like: Tensor) -> Tensor:
    """Return constants with one trailing axis of length 1 per batch axis of `like` [*b]."""
    constant = like.new_tensor(values)
    return constant.reshape(*constant.shape, *(1,) * like.ndim)


def acceleration_per_thrust(vehicle: Vehicle) -> Tensor:
    """Return realised acceleration per newton of each motor, [4, 4, *b].

    Row 0 is m/s^2 along body z and carries the thrust scale, rows 1-3 are rad/s^2 and carry the
    torque scale: each multiplies what is realised, not what is asked for.
    """
    thrust = vehicle.thrust_scale / vehicle.mass_kg
    torque = vehicle.torque_scale / vehicle.inertia_kgm2
    return column(WRENCH_PER_THRUST, vehicle.mass_kg) * torch.cat((thrust[None], torque))[:, None]


def lag_weights(time_constant_s: Tensor, dt_s: float) -> tuple[Tensor, Tensor]:
    """Return what is left of the gap to a constant command at a step's end, and on average, [*b].

    Both exact: exp(-h) and (1 - exp(-h)) / h with h the step over the time constant.
    """
    h = dt_s / time_constant_s
    return torch.exp(-h), -torch.expm1(-h) / h


def respond(thrusts: Tensor, commands: Tensor, left: Tensor) -> Tensor:
    """Return the thrusts [4, *b] N once only `left` [*b] of their gap to `commands` is left."""
    return torch.lerp(commands, thrusts, left)
