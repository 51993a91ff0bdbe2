"""Scene resamples, drawn once and shared by all effects that are bootstrapped jointly."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Self

import numpy as np
from numpy.typing import NDArray

from faultpath.core.streams import generator
from faultpath.stats.inputs import Floats

ROUNDING = 1e-12
"""Draws that spread no more than this are all the same."""
_BLOCK = 50_000
"""Counts of one pass: with intermediate results they fit into a core's own cache."""
_SLACK = 1e-9
"""Tolerance on a count of values, since q times a count may miss a whole number by rounding."""
_MOST_CELLS = 10_000_000
"""Counts of more scenes and resamples are kept in a byte each: 10,000 of either took 800 MB. That
a scene occurs 256 times in a resample has a chance below 1e-500."""


@dataclass(frozen=True, eq=False)
class Resamples:
    """How often each scene occurs in each bootstrap resample.

    ``counts`` is [resamples, scenes]; each row adds up to the number of scenes. Two effects may be
    compared draw by draw only when they share the object.
    """

    label: str
    seed: int
    counts: NDArray[np.float64 | np.uint8] = field(repr=False)

    @classmethod
    def draw(cls, label: str, n_scenes: int, *, seed: int = 0, n_resamples: int = 10_000) -> Self:
        """Draw from the stream ("bootstrap", label, seed); ``label`` names the scene library."""
        if n_scenes < 1 or n_resamples < 1:
            raise ValueError(f"cannot draw {n_resamples} resamples of {n_scenes} scenes")
        stream = generator("bootstrap", label, seed)
        many = n_resamples * n_scenes > _MOST_CELLS
        counts = np.empty((n_resamples, n_scenes), np.uint8 if many else np.float64)
        for rows in _blocks(n_resamples, n_scenes):  # their size does not change the draws
            part = counts[rows]
            chosen = stream.integers(0, n_scenes, size=part.shape)
            chosen += n_scenes * np.arange(len(part))[:, np.newaxis]
            part[:] = np.bincount(chosen.ravel(), minlength=part.size).reshape(part.shape)
        counts.setflags(write=False)  # shared by many effects
        return cls(label=label, seed=seed, counts=counts)

    @property
    def n_resamples(self) -> int:
        """Number of resamples."""
        return self.counts.shape[0]

    @property
    def n_scenes(self) -> int:
        """Number of scenes in the library and in each resample."""
        return self.counts.shape[1]

    def blocks(self) -> Iterator[Floats]:
        """Yield ``counts`` in order, a few resamples at a time, to limit the size of copies."""
        for rows in _blocks(self.n_resamples, self.n_scenes):
            yield self.counts[rows].astype(np.float64, copy=False)

    def sums(self, values: Floats) -> Floats:
        """Return the sums of ``values`` [scenes] or [scenes, k] in each resample."""
        if self.counts.dtype == np.float64:
            return self.counts @ values
        return np.concatenate([block @ values for block in self.blocks()])

    def check(self, n_scenes: int) -> None:
        """Raise `ValueError` for outcomes of another number of scenes."""
        if n_scenes != self.n_scenes:
            raise ValueError(
                f"the outcomes have {n_scenes} scenes, the resamples {self.label!r} have "
                f"{self.n_scenes}"
            )

    def same_as(self, other: "Resamples") -> bool:
        """Return whether both hold the same draws, so that effects may be combined draw by draw."""
        return self is other or np.array_equal(self.counts, other.counts)


def quantiles(
    counts: NDArray[np.float64 | np.uint8], values: Floats, scenes: NDArray[np.intp], q: float
) -> Floats:
    """Return the quantile ``q`` of ``values`` [n] in every resample that holds any of them.

    A resample, a row of ``counts`` [resamples, scenes], holds each value as often as the value's
    scene, ``scenes`` [n]. Where ``q`` times the number of values is a whole number the quantile is
    the mean of the two values beside it, so that 0.5 is the median.
    """
    order = np.argsort(values, kind="stable")
    ordered, columns = values[order], scenes[order]
    parts: list[Floats] = []
    for rows in _blocks(len(counts), len(values)):
        # Number of a resample's values up to and with each: whole numbers, and so exact.
        reached = np.cumsum(counts[rows][:, columns], axis=1, dtype=np.float64)
        reached = reached[reached[:, -1] > 0.0]
        rank = q * reached[:, -1:]
        lower = (reached < rank - _SLACK).sum(axis=1)
        upper = (reached <= rank + _SLACK).sum(axis=1)
        parts.append((ordered[lower] + ordered[upper]) / 2.0)
    return np.concatenate(parts)


def _blocks(rows: int, items: int) -> Iterator[slice]:
    step = max(1, _BLOCK // items)
    return (slice(start, start + step) for start in range(0, rows, step))
