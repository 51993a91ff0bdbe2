"""The vehicle's state, batched with components first and the batch last.

A command has no type of its own: it is a tensor [4, *b], row 0 the collective thrust in N and
rows 1-3 the body-rate command in rad/s (paper, Section "Control Architecture").
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any, Self, cast

import torch
from torch import Tensor

from faultpath_quadrotor import so3

LANE_MULTIPLE = 32
"""Plant lanes come in multiples of this: elementwise kernels treat a tensor's last few elements
apart from the rest, so only whole groups give a scene the same bits in every batch."""


class Batched:
    """A dataclass of tensors, or of other such, with the batch axes last."""

    def map(self, change: Callable[[Tensor], Tensor]) -> Self:
        """Return it with every tensor changed."""
        parts: Any = ((field.name, getattr(self, field.name)) for field in fields(cast(Any, self)))
        return type(self)(
            **{n: change(x) if isinstance(x, Tensor) else x.map(change) for n, x in parts}
        )

    def take(self, index: Tensor | Sequence[int] | slice) -> Self:
        """Return the lanes that an index picks from the last batch axis."""
        return self.map(lambda x: x[..., index])

    @classmethod
    def together(cls, singles: Sequence[Self]) -> Self:
        """Return values without batch axes as one batch, in their order."""
        names = [field.name for field in fields(cast(Any, cls))]
        return cls(**{n: torch.stack([getattr(x, n) for x in singles], dim=-1) for n in names})

    def to(self, target: torch.dtype | torch.device | str) -> Self:
        """Return it in another dtype or on another device."""
        return self.map(lambda x: x.to(target))


@dataclass(frozen=True)
class State(Batched):
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

    @property
    def parts(self) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """All four, in their order."""
        return self.position, self.velocity, self.rotation, self.rate

    @classmethod
    def hover(cls, position: Tensor, yaw: Tensor) -> State:
        """Return vehicles at rest and level at `position` [3, *b] m with heading `yaw` [*b] rad."""
        still = torch.zeros_like(position)
        return cls(position, still, so3.from_yaw(yaw), still.clone())


def padded_lanes(count: int) -> Tensor:
    """Return the lane index, long [n], that fills `count` lanes up to a multiple of 32.

    The first `count` entries are the lanes themselves; the rest repeat lane 0, a valid vehicle
    whose results are thrown away.
    """
    lanes = torch.arange(-(-count // LANE_MULTIPLE) * LANE_MULTIPLE)
    return torch.where(lanes < count, lanes, 0)
