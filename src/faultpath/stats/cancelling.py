"""Errors that cancel: each alone costs success, both together less than either.

Outcomes are success by scene, averaged over seeds where there are several, and NaN where a trial
has none; a comparison uses the scenes in which both have an outcome. An error is named by a number,
a pair by both numbers.

Errors that add up are not tested: on the scale of success rates, harms that are additive inside the
system look like interactions, because of floor and ceiling.
"""

from collections.abc import Mapping, Set
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from faultpath.stats import power, score
from faultpath.stats.decisions import holm
from faultpath.stats.distributions import binomial_cdf
from faultpath.stats.estimate import ALPHA
from faultpath.stats.inputs import Floats

LEVEL, MOST = 0.1, 10
"""Level at which an error goes on to the second stage, and the most errors that do."""
REGAINED = 0.5
"""Share of the worse error's loss that the pair has to regain."""
_DIGITS = 9
"""Digits of means, so that equal ones differ by exactly 0."""
Key: TypeAlias = tuple[int, int]


class StageOne(NamedTuple):
    """Single errors in the first stage, and which of them go on."""

    p_values: Floats
    """[errors]: one-sided, not corrected, of "it hurts"."""
    losses: Floats
    """[errors]: lost success, percentage points."""
    hurting: tuple[int, ...]
    """Errors that go on, the worst first."""


class Single(NamedTuple):
    """A single error, in the scenes that have an outcome both with it and without any error."""

    kind: Literal["hurts", "helps"] | None
    none: float
    """Success without an error, in percent."""
    alone: float
    scenes: int
    p_value: float
    """One-sided, of "it hurts"."""
    corrected_p: float
    """Holm's over all errors."""
    helps_p: float
    """Corrected in the same way, of "it helps"."""


class Pair(NamedTuple):
    """Two errors, in the scenes that have all four outcomes; success in percent."""

    none: float
    first: float
    second: float
    both: float
    scenes: int
    worse: int
    """The error that alone left less success."""
    regained: float | None
    """Share of the worse one's loss that both together regain; None where it lost nothing."""
    p_value: float
    """One-sided, of "both together beat the worse of them alone"; doubled, because the data choose
    which one is worse."""
    corrected_p: float | None = None
    """Holm's over pairs whose errors both hurt alone; None for others."""
    covers_p: float | None = None
    """Holm's over pairs of one source, of "the worse one hurts, and both together beat it"."""
    kind: Literal["cancel", "covers"] | None = None
    covering: int | None = None
    """The error that covers the other one."""


class Cancelling(NamedTuple):
    """Single errors and pairs of a scan."""

    singles: dict[int, Single]
    pairs: dict[Key, Pair]


def stage_one(none: Floats, singles: Floats) -> StageOne:
    """Return which errors go on, from outcomes without an error [scenes] and with each alone
    [errors, scenes]."""
    p_values = ahead(none, singles)
    losses = 100.0 * _means(none - singles)
    order = np.argsort(-losses, kind="stable")
    hurting = [int(error) for error in order if p_values[error] < LEVEL]
    return StageOne(p_values, losses, tuple(hurting[:MOST]))


def cancelling(
    none: Floats,
    singles: Mapping[int, Floats],
    pairs: Mapping[Key, Floats],
    same_source: Set[Key],
) -> Cancelling:
    """Return the effects of errors alone and in pairs, from their outcomes.

    A pair cancels if each error alone hurts, at half of `ALPHA`, and both together beat the worse
    one, at the other half, regain half of its loss, and do no worse than the other one, so that
    correcting only one of them does not help. In a pair of ``same_source`` one error covers the
    other if that one hurts, both together beat it and regain half of its loss, and the first alone
    is not ahead of no error.

    Args:
        none: Outcomes without an error, [scenes].
        singles: Outcomes with each error alone, [scenes].
        pairs: Outcomes with both errors of each pair, [scenes].
        same_source: Those of these pairs whose errors are of one source.
    """
    alone = _singles(none, singles)
    compared = _compared(none, singles, pairs) if pairs else {}
    hurt = [key for key in compared if all(alone[error].kind == "hurts" for error in key)]
    corrected = holm({key: compared[key].p_value for key in hurt})
    covers = holm(
        {
            key: max(compared[key].p_value, 2.0 * alone[compared[key].worse].p_value)
            for key in same_source
        }
    )
    results: dict[Key, Pair] = {}
    for key, pair in compared.items():
        (other,) = set(key) - {pair.worse}
        regains = pair.regained is not None and pair.regained >= REGAINED
        beats_both = pair.both >= max(pair.first, pair.second)
        cancels = regains and beats_both and corrected.get(key, 1.0) <= ALPHA / 2.0
        gains = round(alone[other].alone - alone[other].none, _DIGITS) > 0.0
        covered = regains and not cancels and covers.get(key, 1.0) <= ALPHA and not gains
        results[key] = pair._replace(
            corrected_p=corrected.get(key),
            covers_p=covers.get(key),
            kind="cancel" if cancels else "covers" if covered else None,
            covering=other if covered else None,
        )
    return Cancelling(alone, results)


def fewest_scenes(n_singles: int, n_pairs: int) -> int:
    """Return the least number of scenes with which each error and pair can be significant."""
    return power.fewest_scenes(ALPHA / max(n_singles, 2 * n_pairs, 1))  # two-sided: half of alpha


def ahead(first: Floats, second: Floats) -> Floats:
    """Return [...]: the one-sided p of "``first`` succeeds more than ``second``" [..., scenes].

    If scenes differ wholly or not at all it is exact McNemar's. Else scenes that differ by ``y``
    have the effective number ``(sum |y|)^2 / sum y^2`` of wholly discordant ones, and it is the
    larger of McNemar's among these and the score's, as for audits of several seeds
    (`score.degrees_p_value`).
    """
    differences = np.asarray(first - second).round(_DIGITS)
    values = np.nan_to_num(differences)
    total, size = values.sum(axis=-1), np.abs(values).sum(axis=-1)
    squares = np.maximum(np.square(values).sum(axis=-1), np.finfo(np.float64).tiny)
    fewer = np.maximum(0.5 * size * (size - total) / squares, 0.0)
    p_values = binomial_cdf(fewer, size * size / squares, 0.5)
    by_degrees = (np.abs(values) != np.rint(np.abs(values))).any(axis=-1) & (total > 0.0)
    for at in map(tuple, np.argwhere(by_degrees)):
        kinds, counts = np.unique(differences[at], return_counts=True)
        known = ~np.isnan(kinds)
        two_sided = score.p_value(kinds[known], counts[known].astype(np.float64), 1.0)
        p_values[at] = max(p_values[at], 0.5 * two_sided)
    return p_values


def _singles(none: Floats, singles: Mapping[int, Floats]) -> dict[int, Single]:
    outcomes = np.stack(list(singles.values()))
    hurts, helps = ahead(none, outcomes), ahead(outcomes, none)
    corrected, helping = (
        holm(dict(zip(singles, map(float, p), strict=True))) for p in (hurts, helps)
    )
    known = ~np.isnan(none - outcomes)
    without, alone = (
        _means(np.where(known, values, np.nan))
        for values in (np.broadcast_to(none, known.shape), outcomes)
    )
    results: dict[int, Single] = {}
    for at, error in enumerate(singles):
        hurt, helped = (p[error] <= ALPHA / 2.0 for p in (corrected, helping))
        results[error] = Single(
            kind="hurts" if hurt else "helps" if helped else None,
            none=100.0 * float(without[at]),
            alone=100.0 * float(alone[at]),
            scenes=int(known[at].sum()),
            p_value=float(hurts[at]),
            corrected_p=corrected[error],
            helps_p=helping[error],
        )
    return results


def _compared(
    none: Floats, singles: Mapping[int, Floats], pairs: Mapping[Key, Floats]
) -> dict[Key, Pair]:
    """Return the pairs beside their errors alone, with p-values still uncorrected."""
    both = np.stack(list(pairs.values()))
    parts = np.stack([[singles[key[place]] for key in pairs] for place in (0, 1)])
    outcomes = np.stack([np.broadcast_to(none, both.shape), *parts, both])
    known = ~np.isnan(outcomes.sum(axis=0))
    percent = 100.0 * _means(np.where(known, outcomes, np.nan))
    beats = ahead(both, parts)
    compared: dict[Key, Pair] = {}
    for at, key in enumerate(pairs):
        rates = percent[:, at].round(_DIGITS).tolist()
        second = rates[1] > rates[2] or (rates[1] == rates[2] and beats[1, at] > beats[0, at])
        least = min(rates[1:3])
        lost, won = rates[0] - least, rates[3] - least
        compared[key] = Pair(
            *rates,
            scenes=int(known[at].sum()),
            worse=key[int(second)],
            regained=round(won / lost, _DIGITS) if lost > 0.0 else None,
            p_value=min(1.0, 2.0 * float(beats[int(second), at])),
        )
    return compared


def _means(values: Floats) -> Floats:
    """Return the mean [...] of [..., scenes] without NaN; NaN where all are."""
    known = ~np.isnan(values)
    with np.errstate(invalid="ignore"):
        return np.nansum(values, axis=-1) / known.sum(axis=-1)
