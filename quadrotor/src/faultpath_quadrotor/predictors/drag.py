"""Nominal linear aerodynamics of the predictors: a = R (c o R^T v_air) / m."""

from collections.abc import Callable, Sequence

import torch
from torch import Tensor

from faultpath_quadrotor import so3


class LinearDrag:
    """Force of the air on the vehicle, linear in the air's velocity relative to it."""

    def __init__(self, coefficients_kgps: Sequence[float]) -> None:
        self.coefficients_kgps = tuple(coefficients_kgps)
        # With equal coefficients the rotations cancel: c R R^T v = c v.
        self._isotropic = len(set(self.coefficients_kgps)) == 1

    def force(self, rotation: Tensor, air_velocity: Tensor) -> Tensor:
        """Return the force in the world frame, N, for `air_velocity` `[3, *batch]` (wind - v)."""
        if self._isotropic:
            return air_velocity * self.coefficients_kgps[0]
        body = so3.rotate_back(rotation, air_velocity)
        return so3.rotate(rotation, self._along_axes(body, torch.mul))

    def inverse(self, rotation: Tensor, force: Tensor) -> Tensor:
        """Return the air velocity that would cause `force` `[3, *batch]`, N."""
        if self._isotropic:
            return force / self.coefficients_kgps[0]
        body = so3.rotate_back(rotation, force)
        return so3.rotate(rotation, self._along_axes(body, torch.div))

    def _along_axes(self, body: Tensor, how: Callable[[Tensor, float], Tensor]) -> Tensor:
        # Numbers, no tensor of them: laid on a device at every step, that would wait for the host.
        return torch.stack([how(*each) for each in zip(body, self.coefficients_kgps, strict=True)])
