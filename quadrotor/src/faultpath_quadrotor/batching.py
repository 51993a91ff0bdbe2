"""Batch axes: taps have scenes first, arithmetic has lanes last, planners take chunks of scenes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TypeAlias

import torch
from torch import Tensor

from faultpath.loop import Batch
from faultpath_quadrotor.device import host_readable, send
from faultpath_quadrotor.state import padded_lanes

Read: TypeAlias = tuple[str, str]
"""A channel and the place in the module where it enters: one tap."""

Delivered: TypeAlias = Mapping[Read, Tensor]
"""Readings that the taps delivered at this step, `[..., *batch]`: one entry for each read."""

CHUNK = 13
"""Most scenes planned at once on the CPU: they share the cost of each kernel's start, and their
candidates still stay in cache. A scene's result is the same in a chunk of any size, because its 512
candidates fill whole vectors."""


def lanes_of(batch: Batch, device: torch.device) -> Tensor:
    """Return the scene of each lane of a batch, long `[L]`; the last lanes only fill it up."""
    return padded_lanes(len(batch.scenes)).to(device)


def scenes_first(value: Tensor, count: int) -> Tensor:
    """Turn `[..., L]` lanes into `[B, ...]` scenes."""
    return value[..., :count].movedim(-1, 0)


def lanes_last(value: Tensor, lanes: Tensor) -> Tensor:
    """Turn `[B, ...]` scenes into contiguous `[..., L]` lanes."""
    return value.movedim(0, -1)[..., lanes]


@dataclass(frozen=True)
class Chunk:
    """Some scenes of a block; two chunks of the same scenes are equal."""

    scenes: tuple[int, ...]
    index: Tensor = field(compare=False)
    """The same, long `[S]`, where the flight is computed."""

    @property
    def rows(self) -> slice | Tensor:
        """Index of the scenes in a block: a slice where they are adjacent, which copies nothing."""
        first, last = self.scenes[0], self.scenes[-1]
        whole = last - first + 1 == len(self.scenes)
        return slice(first, last + 1) if whole else self.index


def chunks(running: Sequence[int], device: torch.device) -> tuple[Chunk, ...]:
    """Split scenes into as few chunks as possible, of nearly equal size; one on an accelerator."""
    count = -(-len(running) // CHUNK) if host_readable(device) else 1
    ends = [len(running) * i // count for i in range(count + 1)]
    parts = (tuple(running[a:b]) for a, b in pairwise(ends))
    return tuple(Chunk(part, send(torch.tensor(part), device)) for part in parts)
