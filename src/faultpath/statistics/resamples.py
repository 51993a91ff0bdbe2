"""Scene resamples, drawn once and shared by every effect that is to be bootstrapped jointly."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Self

import numpy as np

from faultpath.core.streams import generator
from faultpath.statistics.inputs import Floats

_BLOCK = 50_000
"""Counts worked on at a time: with what comes between, they fit into a core's own cache."""


@dataclass(frozen=True, eq=False)
class Resamples:
    """How often each scene occurs in each bootstrap resample.

    ``counts`` is [resamples, scenes]; each row adds up to the number of scenes. One product with a
    [scenes] or [scenes, k] array gives the resampled sums of any number of effects. Two effects
    may be compared draw by draw only when they share the object.
    """

    label: str
    seed: int
    counts: Floats = field(repr=False)

    @classmethod
    def draw(cls, label: str, n_scenes: int, *, seed: int = 0, n_resamples: int = 10_000) -> Self:
        """Draw from the stream ("bootstrap", label, seed); ``label`` names the scene library."""
        if n_scenes < 1 or n_resamples < 1:
            raise ValueError(f"cannot draw {n_resamples} resamples of {n_scenes} scenes")
        drawn = _counts(generator("bootstrap", label, seed), n_resamples, n_scenes)
        drawn.setflags(write=False)  # shared by many effects
        return cls(label=label, seed=seed, counts=drawn)

    @property
    def n_resamples(self) -> int:
        """Return the number of resamples."""
        return self.counts.shape[0]

    @property
    def n_scenes(self) -> int:
        """Return the number of scenes in the library and in each resample."""
        return self.counts.shape[1]

    def blocks(self) -> Iterator[Floats]:
        """Yield ``counts`` in order, a few resamples at a time, for work that copies them."""
        for rows in _blocks(self.n_resamples, self.n_scenes):
            yield self.counts[rows]

    def same_as(self, other: "Resamples") -> bool:
        """Return whether both hold the same draws, so that effects on them are joint."""
        return self is other or np.array_equal(self.counts, other.counts)


def _counts(stream: np.random.Generator, rows: int, items: int) -> Floats:
    """Return [rows, items]: how often each item comes up in ``items`` equally likely draws.

    Where the blocks end does not matter: the stream goes on from one to the next.
    """
    counts = np.empty((rows, items))
    for block in _blocks(rows, items):
        part = counts[block]
        chosen = stream.integers(0, items, size=part.shape)
        chosen += items * np.arange(len(part))[:, np.newaxis]
        part[:] = np.bincount(chosen.ravel(), minlength=part.size).reshape(part.shape)
    return counts


def _blocks(rows: int, items: int) -> Iterator[slice]:
    step = max(1, _BLOCK // items)
    return (slice(start, start + step) for start in range(0, rows, step))
