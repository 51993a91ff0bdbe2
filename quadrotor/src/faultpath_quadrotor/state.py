"""The vehicle's state, batched with components first and the batch last.

A command has no type of its own: it is a tensor [4, *b], row 0 the collective thrust in N and
rows 1-3 the body-rate command in rad/s (paper, Section "Control Architecture").
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from faultpath_quadrotor import so3

LANE_MULTIPLE = 32
"""Plant lanes come in multiples of this: elementwise kernels treat a tensor's last few elements
apart from the rest, so only whole groups give a scene the same bits in every batch."""


@dataclass(frozen=True)
class State:
    """Where a vehicle is and how it moves; `*b` is any batch shape, the same for all four."""

    position: Tensor
    """World frame, m, [3, *b]."""
    velocity: Tensor
    """World frame, m/s, [3, *b]."""
    rotation: Tensor
    """Body to world, [3, 3, *b]."""
    rate: Tensor
    """Body frame, rad/s, [3, *b]."""

    @property
    def batch(self) -> torch.Size:
        """The batch shape `*b`."""
        return self.position.shape[1:]

    @classmethod
    def hover(cls, position: Tensor, yaw: Tensor) -> State:
        """Return vehicles at rest and level at `position` [3, *b] m with heading `yaw` [*b] rad."""
        still = torch.zeros_like(position)
        return cls(position, still, so3.from_yaw(yaw), still.clone())

    def take(self, index: Tensor) -> State:
        """Return the lanes that `index` (long or bool, [n]) picks from the last batch axis."""
        return State(
            self.position[..., index],
            self.velocity[..., index],
            self.rotation[..., index],
            self.rate[..., index],
        )

    def to(self, target: torch.dtype | torch.device | str) -> State:
        """Return the state in another dtype or on another device."""
        return State(
            self.position.to(target),
            self.velocity.to(target),
            self.rotation.to(target),
            self.rate.to(target),
        )


def padded_lanes(count: int) -> Tensor:
    """Return the lane index, long [n], that fills `count` lanes up to a multiple of 32.

    The first `count` entries are the lanes themselves; the rest repeat lane 0, a valid vehicle
    whose results are thrown away.
    """
    lanes = torch.arange(-(-count // LANE_MULTIPLE) * LANE_MULTIPLE)
    return torch.where(lanes < count, lanes, 0)
