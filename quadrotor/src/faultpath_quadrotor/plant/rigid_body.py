"""Rotation of a rigid body with principal axes along the body frame."""

import torch
from torch import Tensor

from faultpath_quadrotor import so3
from faultpath_quadrotor.plant.vehicle_batch import Vehicle


def gyroscopic_coupling(vehicle: Vehicle) -> Tensor:
    """Return (Iy - Iz) / Ix and its cyclic companions, [3, *b]."""
    x, y, z = vehicle.inertia_kgm2.unbind(0)
    return torch.stack(((y - z) / x, (z - x) / y, (x - y) / z))


def gyroscopic(coupling: Tensor, rate: Tensor) -> Tensor:
    """Return the torque-free angular acceleration -I^-1 (rate x I rate), [3, *b] rad/s^2."""
    cyclic = torch.cat((rate, rate[:2]))
    return (cyclic[1:4] * cyclic[2:5]).mul_(coupling)


def turn(
    rotation: Tensor, rate: Tensor, torque: Tensor, coupling: Tensor, free: Tensor, dt_s: float
) -> tuple[Tensor, Tensor]:
    """Return attitude and body rate after `dt_s`: explicit midpoint, exponential map.

    `torque` [3, *b] is the step's mean angular acceleration from torque, `free` [3, *b] the
    gyroscopic one at its start, both rad/s^2. Second order.
    """
    middle = torch.add(rate, torque + free, alpha=0.5 * dt_s)
    end = torch.add(rate, gyroscopic(coupling, middle).add_(torque), alpha=dt_s)
    return so3.compose(rotation, so3.exp(middle.mul_(dt_s))), end
