"""The fault frequency from which on a repair pays off (paper, Table V and its footnote).

In a mixture that meets the fault with probability p the expected difference is
``(1 - p) * delta_0 + p * delta_f``. Frequencies at which it cannot be distinguished from 0 are a
confidence set for the break-even frequency (Fieller, Journal of the Royal Statistical Society B
16:175, 1954).
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from faultpath.stats import betting, score
from faultpath.stats.contrast import Contrast, check_joint
from faultpath.stats.distributions import t_interval
from faultpath.stats.estimate import SCENES_AND_SEEDS, BreakEven, Region
from faultpath.stats.inputs import Floats

_GRID, _POINTS = 400, 41
_HALVINGS = 40
_DIGITS = 9
"""Digits of a mixture's values, so that values which cancel leave exactly 0."""
Bools = NDArray[np.bool_]
Piece = tuple[float, float]
Ends = tuple[Contrast, Contrast]
Share = TypeVar("Share", float, Floats)


def break_even(
    correct: Contrast, faulty: Contrast, level: float = 0.95, fills: Sequence[Ends] = ()
) -> BreakEven:
    """Return the fault frequencies at which one variant is significantly ahead, and the rest.

    ``correct`` and ``faulty`` are effects on the same scenes, without and with the fault. At every
    frequency the mixture has the test of the effects' own intervals: the picture's band
    (`mixture_curve`) touches 0 exactly where a frequency is in the set. ``fills`` are both effects
    with missing outcomes filled in; all of them have to favour the same variant.
    """
    mixture, *others = (_Mixture(*ends, level) for ends in ((correct, faulty), *fills))

    def inconclusive(p: Floats) -> Bools:
        opposed = [np.sign(other.value(p)) != np.sign(mixture.value(p)) for other in others]
        return np.any([*opposed, *(mix.inconclusive(p) for mix in (mixture, *others))], axis=0)

    delta_0, delta_f = correct.value, faulty.value
    grid = np.linspace(0.0, 1.0, _GRID + 1)
    p_star = None
    if delta_0 != delta_f and delta_0 * delta_f <= 0.0:
        p_star = delta_0 / (delta_0 - delta_f) + 0.0
        grid = np.unique(np.append(grid, p_star))
    pieces = list(pieces_of(inconclusive, grid))
    while len(pieces) > 2:  # not known to happen; closing a gap only claims less
        gaps = [after[0] - before[1] for before, after in pairwise(pieces)]
        least = int(np.argmin(gaps))
        pieces[least : least + 2] = [(pieces[least][0], pieces[least + 1][1])]
    edges = [0.0, *(edge for piece in pieces for edge in piece), 1.0]
    return BreakEven(
        p_star=p_star,
        pieces=tuple(pieces),
        kind=_kind(pieces),
        regions=tuple(
            Region(low=low, high=high, sign=1 if mixture.value(0.5 * (low + high)) > 0 else -1)
            for low, high in zip(edges[::2], edges[1::2], strict=True)
            if low < high
        ),
        level=level,
        method=f"inverted {correct.method}, mixture of both conditions",
        estimand=correct.estimand,
    )


def only(whole: BreakEven, regions: Sequence[Region]) -> BreakEven:
    """Return a break-even set with only some of its regions left."""
    edges = [0.0, *(end for region in regions for end in (region.low, region.high)), 1.0]
    spans = zip(edges[::2], edges[1::2], strict=True)
    # A set that begins or ends in a single frequency keeps it.
    pieces = tuple(span for span in spans if span[0] < span[1] or span in whole.pieces)
    return whole.model_copy(
        update={"pieces": pieces, "kind": _kind(pieces), "regions": tuple(regions)}
    )


def _kind(pieces: Sequence[Piece]) -> Literal["interval", "empty", "whole", "two pieces"]:
    if len(pieces) != 1:
        return "two pieces" if pieces else "empty"
    return "whole" if pieces[0] == (0.0, 1.0) else "interval"


def mixture_curve(
    correct: Contrast, faulty: Contrast, level: float = 0.95, fills: Sequence[Ends] = ()
) -> tuple[tuple[float, float, float, float], ...]:
    """Return ``(p, expected difference, low, high)`` at evenly spaced fault frequencies p."""
    mixture, p = _Mixture(correct, faulty, level), np.linspace(0.0, 1.0, _POINTS)
    bands = [mixture.intervals(p), *(_Mixture(*ends, level).intervals(p) for ends in fills)]
    lows, highs = (np.array(part) for part in zip(*bands, strict=True))
    ends = zip(lows.min(axis=0).tolist(), highs.max(axis=0).tolist(), strict=True)
    return tuple(
        (at, mixture.value(at), low + 0.0, high + 0.0)
        for at, (low, high) in zip(p.tolist(), ends, strict=True)
    )


class _Mixture:
    """The difference at fault frequencies ``p`` [frequencies], with its test and interval."""

    def __init__(self, correct: Contrast, faulty: Contrast, level: float) -> None:
        check_joint(correct, faulty)
        first, second = correct.scenes, faulty.scenes
        if first is None or second is None:
            raise ValueError("only effects on bounded outcomes have a break-even frequency")
        # Each by itself and then their pairs: NumPy sorts columns some ten times slower.
        (ones, one), (twos, two) = (
            np.unique(scenes.scale * scenes.values, return_inverse=True)
            for scenes in (first, second)
        )
        pairs, counts = np.unique(one * len(twos) + two, return_counts=True)
        self.kinds: Floats = np.stack([ones[pairs // len(twos)], twos[pairs % len(twos)]])
        self.counts: Floats = counts.astype(np.float64)
        self.far = first.scale * first.far, second.scale * second.far
        self.bounds = first.scale * first.bound, second.scale * second.bound
        self.like, self.level = first, level
        self.ends = correct, faulty
        self.models = correct.estimand == SCENES_AND_SEEDS

    def value(self, p: Share) -> Share:
        """Return the expected difference at a frequency, or at many."""
        return (1.0 - p) * self.ends[0].value + p * self.ends[1].value + 0.0

    def inconclusive(self, p: Floats) -> Bools:
        """Return [frequencies]: whether neither variant is significantly ahead there."""
        if self.models:
            low, high = self.intervals(p)
            return (low <= 0.0) & (high >= 0.0)
        values, counts, far, bound = self._scenes(p)
        if self.like.test == "sequential":
            return ~betting.rejects(values, counts, 0.0, far, self.level)
        if self.like.test == "unconditional":
            return ~score.degrees_rejects(values, counts, bound, 1.0 - self.level)
        return ~score.rejects(values, counts, 0.0, far, score.quantile(self.level))

    def intervals(self, p: Floats) -> tuple[Floats, Floats]:
        """Return both ends [frequencies] of the difference's interval at each."""
        values, counts, far, bound = self._scenes(p)
        low, high = self.like.ends(values, counts, far, bound, self.level)
        if self.models:
            one, two = (np.asarray(end.per_seed) for end in self.ends)
            share = p[:, np.newaxis]
            seeds = (1.0 - share) * one + share * two
            ends = t_interval(seeds, self.level, self.ends[0].rounding)
            low, high = np.minimum(low, ends[0]), np.maximum(high, ends[1])
        return low, high

    def _scenes(self, p: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        share = p[:, np.newaxis]
        mixed: Floats = (1.0 - share) * self.kinds[0] + share * self.kinds[1]
        values = mixed.round(_DIGITS)
        far, bound = ((1.0 - p) * one + p * two for one, two in (self.far, self.bounds))
        return values, np.broadcast_to(self.counts, values.shape), far, bound


def pieces_of(condition: Callable[[Floats], Bools], grid: Floats) -> tuple[Piece, ...]:
    """Return the intervals in which a condition holds: found on ``grid``, their ends bisected."""
    inside = condition(grid)
    at = np.flatnonzero(inside[1:] != inside[:-1])
    low, high, state = grid[at], grid[at + 1], inside[at]
    for _ in range(_HALVINGS if len(at) else 0):
        middle = 0.5 * (low + high)
        same = condition(middle) == state
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    edges: list[float] = np.where(state, low, high).tolist()
    if inside[0]:
        edges = [float(grid[0]), *edges]
    if inside[-1]:
        edges = [*edges, float(grid[-1])]
    return tuple(zip(edges[::2], edges[1::2], strict=True))
