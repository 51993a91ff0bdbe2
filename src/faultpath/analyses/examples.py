"""Which scenes stand as examples, and how many go like each.

A scene with one seed shows who succeeded under each condition: its pattern. Patterns come first
that show the most reversals, then those that show the most significant effects, less what they
contradict, then those in which not everything ends alike, then those that more scenes have. Of
each of the first six patterns the typical scene is shown: the one whose trials have parted at the
median time. Trials that end differently have parted when the first of the two ends, which is all
that is known of scenes of which no signals were recorded. Places left over are filled in the same
order. They are examples, not a sample.
"""

import math
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from statistics import median_low
from typing import TypeAlias

from faultpath.analyses.model import SHARED, AuditResult
from faultpath.analyses.pairs import Pair, PairKind, by_scene

At: TypeAlias = tuple[str, int]
"""A scene and a seed."""
Pattern: TypeAlias = tuple[tuple[str, PairKind], ...]
"""Who succeeds, condition by condition."""

_MOST = 6


def choose(
    record: AuditResult, pairs: Sequence[Pair], recorded: Collection[At] = ()
) -> tuple[At, ...]:
    """Return up to six scenes with their seeds by the rule at the top.

    Of scenes that go alike those that a run has `recorded` come first: its examples stay.
    """
    patterns, index = _patterns(pairs), {(pair.scene, pair.seed): pair.index for pair in pairs}
    away = _away(pairs, patterns)
    counts = Counter(patterns.values())
    signs = {effect.condition: effect.sign for effect in record.effects if effect.leads}
    variants = {PairKind.REPAIR_ONLY: 1, PairKind.BASELINE_ONLY: -1}

    def order(at: At) -> tuple[float, ...]:
        pattern = patterns[at]
        shown = {
            condition: signs.get(condition, 0) * variants.get(kind, 0)
            for condition, kind in pattern
        }
        reversals = sum(
            change.turn == "reversal" and shown.get(change.isolated) == shown.get(SHARED) == 1
            for change in record.changes
        )
        alike = len({kind for _, kind in pattern}) == 1 and pattern[0][1] not in variants
        shows = (-reversals, -sum(shown.values()), alike, -counts[pattern])
        return *shows, at not in recorded, away[at], index[at], at[1]

    ranked = sorted(patterns, key=order)
    chosen: list[At] = []
    for only_new_patterns in (True, False):
        for at in ranked:
            seen = only_new_patterns and patterns[at] in (patterns[other] for other in chosen)
            shown = at[0] in (scene for scene, _ in chosen)
            if len(chosen) < _MOST and not shown and not seen:
                chosen.append(at)
    return tuple(at for at in ranked if at in chosen)


def alike(pairs: Sequence[Pair]) -> dict[At, tuple[int, bool]]:
    """Return of each scene and seed how many go like it, itself included, and whether it is typical
    of them: some end apart at other times, and it does at the median."""
    patterns = _patterns(pairs)
    like, away = Counter(patterns.values()), _away(pairs, patterns)
    varied = {patterns[at] for at, seconds in away.items() if seconds}
    return {
        at: (like[pattern], pattern in varied and not away[at]) for at, pattern in patterns.items()
    }


def _away(pairs: Sequence[Pair], patterns: Mapping[At, Pattern]) -> dict[At, float]:
    """Return how far from the median of its pattern the trials of a scene have parted, s."""
    groups = by_scene(pairs)
    parted = {at: _parted_s(groups[at]) for at in patterns}
    times: dict[Pattern, list[float]] = {}
    for at, pattern in patterns.items():
        times.setdefault(pattern, []).append(parted[at])
    medians = {pattern: median_low(of) for pattern, of in times.items()}
    return {at: abs(parted[at] - medians[pattern]) for at, pattern in patterns.items()}


def _parted_s(pairs: Mapping[str, Pair]) -> float:
    """Return when the pairs of a scene that end differently have parted, summed; of all pairs where
    none does. Other tools need not say times: these count as none."""
    apart = [pair for pair in pairs.values() if pair.sign] or list(pairs.values())
    times = (min(trial.time_s for trial in (pair.baseline, pair.repair) if trial) for pair in apart)
    return sum(time for time in times if not math.isnan(time))


def _patterns(pairs: Sequence[Pair]) -> dict[At, Pattern]:
    """Return who succeeded, condition by condition, in every scene and seed without a void pair."""
    return {
        at: tuple((condition, pair.kind) for condition, pair in group.items())
        for at, group in by_scene(pairs).items()
        if not any(pair.kind is PairKind.VOID for pair in group.values())
    }
