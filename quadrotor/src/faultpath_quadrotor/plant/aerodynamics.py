"""Linear drag through air-relative velocity: a = R (c o R^T (w - v)) / m (paper, Section IV-B)."""

import torch
from torch import Tensor

from faultpath_quadrotor import so3
from faultpath_quadrotor.plant.vehicle_batch import Vehicle


def relaxation(vehicle: Vehicle, dt_s: float) -> Tensor:
    """Return the part of the air-relative velocity that drag takes in one step, [3, *b].

    Exact for a fixed attitude: 1 - exp(-c dt / m) along each body axis.
    """
    return -torch.expm1(vehicle.drag_kgps * (-dt_s / vehicle.mass_kg))


def velocity_change(rotation: Tensor, air_velocity: Tensor, relaxed: Tensor) -> Tensor:
    """Return the world-frame velocity [3, *b] that drag adds for air-relative w - v [3, *b]."""
    return so3.rotate(rotation, so3.rotate_back(rotation, air_velocity).mul_(relaxed))
