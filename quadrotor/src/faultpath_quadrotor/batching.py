"""Batch axes: taps have scenes first, arithmetic has lanes last, planners take chunks of scenes."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, TypeAlias

import torch
from torch import Tensor
from typing_extensions import override

from faultpath.loop import Batch, Inputs, Memory, Module, Outputs, Query
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


def scenes_first(value: Tensor, count: int) -> Tensor:
    """Turn `[..., L]` lanes into `[B, ...]` scenes."""
    return value[..., :count].movedim(-1, 0)


def lanes_last(value: Tensor, lanes: Tensor) -> Tensor:
    """Turn `[B, ...]` scenes into contiguous `[..., L]` lanes."""
    return value.movedim(0, -1)[..., lanes]


class LaneModule(Module):
    """A module that computes with lanes last: this is where its readings and outputs are turned."""

    def __init__(self, device: torch.device) -> None:
        self._device = device

    @override
    def begin(self, batch: Batch) -> Memory:
        lanes = padded_lanes(len(batch.scenes)).to(self._device)
        return lanes, len(batch.scenes), None

    @override
    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        lanes, count, known = memory
        readings = {read: lanes_last(value, lanes) for read, value in inputs.items()}
        outputs, known = self.compute(readings, inputs.step, known)
        turned = {
            source: value if isinstance(value, Query) else scenes_first(value, count)
            for source, value in outputs.items()
        }
        return turned, (lanes, count, known)

    @abstractmethod
    def compute(self, readings: Delivered, step: int, memory: Any) -> tuple[Outputs, Any]:
        """Return what it writes, `[..., L]` or queries, and its memory, which begins as `None`."""


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


def into_chunks(running: Sequence[int], device: torch.device) -> tuple[Chunk, ...]:
    """Split scenes into as few chunks as possible, of nearly equal size; one on an accelerator."""
    count = -(-len(running) // CHUNK) if host_readable(device) else 1
    ends = [len(running) * i // count for i in range(count + 1)]
    groups = (tuple(running[a:b]) for a, b in pairwise(ends))
    return tuple(Chunk(group, send(torch.tensor(group), device)) for group in groups)
