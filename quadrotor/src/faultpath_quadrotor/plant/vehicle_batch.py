"""A batch of vehicles as tensors: what the plant flies."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import torch
from torch import Tensor

from faultpath_quadrotor.state import Batched
from faultpath_quadrotor.vehicle import GRAVITY_MPS2, VehicleParameters


@dataclass(frozen=True)
class Vehicle(Batched):
    """A batch of vehicles as tensors; `*b` is the batch shape."""

    mass_kg: Tensor
    """[*b]"""
    thrust_scale: Tensor
    """Realised thrust over commanded, [*b]: acceleration is `thrust_scale * u / mass_kg`."""
    torque_scale: Tensor
    """Realised torque over commanded, [*b]."""
    inertia_kgm2: Tensor
    """Principal moments along the body axes, [3, *b]."""
    motor_time_constant_s: Tensor
    """[*b]"""
    drag_kgps: Tensor
    """Linear drag along the body axes, [3, *b]."""

    @classmethod
    def nominal(
        cls, batch: int | Sequence[int] = (), dtype: torch.dtype = torch.float64
    ) -> Vehicle:
        """Return `batch` nominal vehicles (a count or a batch shape)."""
        shape = (batch,) if isinstance(batch, int) else tuple(batch)
        lanes = cls.stack([VehicleParameters()] * math.prod(shape), dtype)
        return lanes.map(lambda x: x.view((*x.shape[:-1], *shape)))

    @classmethod
    def stack(
        cls, parameters: Sequence[VehicleParameters], dtype: torch.dtype = torch.float64
    ) -> Vehicle:
        """Return the vehicles of a list as one batch, in its order."""
        return cls(
            **{
                field.name: torch.tensor(
                    np.array([getattr(p, field.name) for p in parameters]).T, dtype=dtype
                ).contiguous()
                for field in fields(cls)
            }
        )

    @property
    def batch(self) -> torch.Size:
        """The batch shape `*b`."""
        return self.mass_kg.shape

    @property
    def hover_thrust_n(self) -> Tensor:
        """Collective thrust command that balances the weight, N, [*b]."""
        return self.mass_kg * GRAVITY_MPS2 / self.thrust_scale

    def hover_command(self) -> Tensor:
        """Return the command that holds a level vehicle at rest, [4, *b]."""
        thrust = self.hover_thrust_n
        return torch.cat((thrust[None], torch.zeros(3, *self.batch).to(thrust)))
