"""The fault frequency from which on a repair pays (paper, Table V and its footnote).

In a mixture that meets the fault with probability p the expected difference is
``(1 - p) * delta_0 + p * delta_f``. Frequencies at which it is not told from 0 are a confidence
set for the break-even frequency (Fieller, Journal of the Royal Statistical Society B 16:175, 1954).
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from faultpath.statistics import betting
from faultpath.statistics.contrast import Contrast, check_joint, percentile_interval
from faultpath.statistics.distributions import t_interval
from faultpath.statistics.estimate import SCENES_AND_SEEDS, BreakEven, Region
from faultpath.statistics.inputs import Floats
from faultpath.statistics.score import interval, quantile, rejects

_GRID = 400
_HALVINGS = 40
_DIGITS = 9
"""Of a mixture's values, so that values which cancel leave exactly 0."""
Bools = NDArray[np.bool_]
Piece = tuple[float, float]


def break_even_point(delta_0: float, delta_f: float) -> float | None:
    """Return where ``(1 - p) delta_0 + p delta_f`` is 0, or None when it is nowhere or everywhere.

    ``p* = -delta_0 / (delta_f - delta_0)``, when that lies between 0 and 1.
    """
    if delta_0 == delta_f or delta_0 * delta_f > 0.0:
        return None
    return delta_0 / (delta_0 - delta_f) + 0.0


def break_even(correct: Contrast, faulty: Contrast, level: float = 0.95) -> BreakEven:
    """Return at which fault frequencies who is ahead is decided, and at which it is not.

    ``correct`` and ``faulty`` are effects on the same scenes, without and with the fault. At every
    frequency the test is that of the effects' own intervals, on the mixture: the picture's band
    (`mixture_curve`) touches 0 exactly where a frequency is in the set.
    """
    mixture = _Mixture(correct, faulty, level)
    p_star = break_even_point(correct.value, faulty.value)
    pieces = _pieces(mixture, p_star)
    regions = _regions(pieces, mixture)
    return BreakEven(
        p_star=p_star,
        pieces=pieces,
        kind=_kind(pieces),
        regions=regions,
        level=level,
        method=f"inverted {correct.method}, mixture of both conditions",
        estimand=correct.estimand,
    )


def only(found: BreakEven, regions: Sequence[Region]) -> BreakEven:
    """Return what is left where of all regions only some are decided."""
    edges = [0.0, *(end for each in regions for end in (each.low, each.high)), 1.0]
    spans = zip(edges[::2], edges[1::2], strict=True)
    # A set that begins or ends in a single frequency keeps it.
    pieces = tuple(span for span in spans if span[0] < span[1] or span in found.pieces)
    return found.model_copy(
        update={
            "pieces": pieces,
            "kind": _kind(pieces),
            "regions": tuple(regions),
        }
    )


def _kind(pieces: Sequence[Piece]) -> Literal["interval", "empty", "whole", "two pieces"]:
    if len(pieces) != 1:
        return "two pieces" if pieces else "empty"
    return "whole" if pieces[0] == (0.0, 1.0) else "interval"


def mixture_curve(
    correct: Contrast, faulty: Contrast, points: int = 41, level: float = 0.95
) -> tuple[tuple[float, float, float, float], ...]:
    """Return ``(p, expected difference, low, high)`` at evenly spaced fault frequencies p."""
    mixture = _Mixture(correct, faulty, level)
    p = np.linspace(0.0, 1.0, points)
    ends = zip(*(end.tolist() for end in mixture.intervals(p)), strict=True)
    return tuple(
        (at, mixture.value(at), low + 0.0, high + 0.0)
        for at, (low, high) in zip(p.tolist(), ends, strict=True)
    )


class _Mixture:
    """What is known of the difference at fault frequencies."""

    def __init__(self, correct: Contrast, faulty: Contrast, level: float) -> None:
        check_joint(correct, faulty)
        self.ends = correct, faulty
        self.level = level
        self.resampled = correct.resampled or faulty.resampled
        self.models = correct.estimand == SCENES_AND_SEEDS
        self.scenes, self.sequential = None, False
        first, second = correct.scenes, faulty.scenes
        if first is not None and second is not None:
            both = np.stack([first.scale * first.values, second.scale * second.values])
            unique, counts = np.unique(both, axis=1, return_counts=True)
            self.sequential = first.sequential
            self.scenes = unique, counts, first.scale * first.far, second.scale * second.far

    def value(self, p: float) -> float:
        """Return the expected difference at a frequency."""
        return (1.0 - p) * self.ends[0].value + p * self.ends[1].value + 0.0

    def undecided(self, p: Floats) -> Bools:
        """Return [frequencies]: whether the difference at each is not told from 0."""
        if not (self.resampled or self.models):
            values, counts, far = self._mixed(p)
            if self.sequential:
                return ~betting.rejects(values, counts, 0.0, far, self.level)
            return ~rejects(values, counts, 0.0, far, quantile(self.level))
        low, high = self.intervals(p)
        return (low <= 0.0) & (high >= 0.0)

    def intervals(self, p: Floats) -> tuple[Floats, Floats]:
        """Return both ends [frequencies] of the difference's interval at each."""
        ends: list[tuple[Floats, Floats]] = []
        if self.scenes is not None:
            values = self._mixed(p)
            ends.append(
                betting.interval(*values, self.level)
                if self.sequential
                else interval(*values, quantile(self.level))
            )
        if self.models:
            seeds = [np.asarray(end.per_seed) for end in self.ends]
            share = p[:, np.newaxis]
            mixed = (1.0 - share) * seeds[0] + share * seeds[1]
            ends.append(t_interval(mixed, self.level, self.ends[0].rounding))
        if self.resampled:
            first, second = (end.draws for end in self.ends)
            drawn = ((1.0 - each) * first + each * second for each in p.tolist())
            low, high = np.array([percentile_interval(draws, self.level) for draws in drawn]).T
            ends.append((low, high))
        lows, highs = zip(*ends, strict=True)
        return np.minimum.reduce(lows), np.maximum.reduce(highs)

    def _mixed(self, p: Floats) -> tuple[Floats, Floats, Floats]:
        assert self.scenes is not None
        (first, second), counts, far_0, far_f = self.scenes
        share = p[:, np.newaxis]
        mixed: Floats = (1.0 - share) * first + share * second
        values = mixed.round(_DIGITS)
        often = np.broadcast_to(counts.astype(np.float64), values.shape)
        return values, often, (1.0 - p) * far_0 + p * far_f


def _pieces(mixture: _Mixture, p_star: float | None) -> tuple[Piece, ...]:
    grid = np.linspace(0.0, 1.0, _GRID + 1)
    if p_star is not None:
        grid = np.unique(np.append(grid, p_star))
    pieces = list(pieces_of(mixture.undecided, grid))
    while len(pieces) > 2:  # not known to happen; closing a gap only claims less
        gaps = [after[0] - before[1] for before, after in pairwise(pieces)]
        least = int(np.argmin(gaps))
        pieces[least : least + 2] = [(pieces[least][0], pieces[least + 1][1])]
    return tuple(pieces)


def pieces_of(undecided: Callable[[Floats], Bools], grid: Floats) -> tuple[Piece, ...]:
    """Return where something is not decided, as intervals: seen at ``grid``, ends by bisection."""
    inside = undecided(grid)
    edges = _edges(undecided, grid, inside)
    if inside[0]:
        edges = [float(grid[0]), *edges]
    if inside[-1]:
        edges = [*edges, float(grid[-1])]
    return tuple(zip(edges[::2], edges[1::2], strict=True))


def _edges(undecided: Callable[[Floats], Bools], grid: Floats, inside: Bools) -> list[float]:
    at = np.flatnonzero(inside[1:] != inside[:-1])
    if not len(at):
        return []
    low, high, state = grid[at], grid[at + 1], inside[at]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        same = undecided(middle) == state
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return np.where(state, low, high).tolist()


def _regions(pieces: tuple[Piece, ...], mixture: _Mixture) -> tuple[Region, ...]:
    edges = [0.0, *(edge for piece in pieces for edge in piece), 1.0]
    spans = [(low, high) for low, high in zip(edges[::2], edges[1::2], strict=True) if low < high]
    return tuple(
        Region(low=low, high=high, sign=1 if mixture.value(0.5 * (low + high)) > 0 else -1)
        for low, high in spans
    )
