"""Pairs of trials, both variants in the same scene, condition and seed, as pages show them, and
which scenes stand as examples.

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
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from statistics import median_low
from typing import TypeAlias

import numpy as np

from faultpath.analyses.model import SHARED, AuditResult
from faultpath.run.pairing import Group, pair, unlike
from faultpath.run.trials import Trials
from faultpath.system.outcome import Outcome, Status

At: TypeAlias = tuple[str, int]
"""A scene and a seed."""

MOST_SCENES = 1000
"""Scenes that a page shows one by one; of more it shows these and counts all."""
MOST_EXAMPLES = 6


class PairKind(StrEnum):
    """How the two trials of a pair ended."""

    BOTH = "both"
    REPAIR_ONLY = "repair-only"
    BASELINE_ONLY = "baseline-only"
    NEITHER = "neither"
    VOID = "void"


Pattern: TypeAlias = tuple[tuple[str, PairKind], ...]
"""Who succeeds, condition by condition."""


@dataclass(frozen=True)
class Pair:
    """Both variants in one scene under one condition with one seed; a variant is `None` when it
    never ran."""

    condition: str
    seed: int
    scene: str
    index: int
    topology: str
    baseline: Outcome | None
    repair: Outcome | None

    @cached_property
    def void_reason(self) -> str | None:
        """Why the pair does not count, or `None` for one that does."""
        for variant, trial in (("baseline", self.baseline), ("repair", self.repair)):
            if trial is None:
                return f"the {variant} did not run"
            if trial.failed:
                return f"the {variant} failed: {trial.error or 'no message was kept'}"
        if self.baseline and self.repair and unlike(self.baseline, self.repair):
            return "the two trials differ in initial state, disturbance or planner noise"
        return None

    @cached_property
    def kind(self) -> PairKind:
        """Kind of the pair."""
        if self.void_reason is not None or self.baseline is None or self.repair is None:
            return PairKind.VOID
        one, two = (t.status is Status.SUCCESS for t in (self.baseline, self.repair))
        if one is two:
            return PairKind.BOTH if one else PairKind.NEITHER
        return PairKind.REPAIR_ONLY if two else PairKind.BASELINE_ONLY

    @property
    def sign(self) -> int:
        """+1 where only the repair succeeds, -1 where only the baseline does, else 0."""
        return {PairKind.REPAIR_ONLY: 1, PairKind.BASELINE_ONLY: -1}.get(self.kind, 0)


def read_pairs(trials: Trials, result: AuditResult) -> tuple[Pair, ...]:
    """Return the pairs that a page shows, ordered by condition, topology, scene index and seed.

    These are all pairs of both versions, or those of `MOST_SCENES` scenes that lie evenly
    among more.
    """
    question = result.question
    places = range(len(trials.scenes))
    if is_sample(trials):
        places = np.linspace(0, len(trials.scenes) - 1, MOST_SCENES).astype(int).tolist()
    pairs: list[Pair] = []
    for condition in result.conditions:
        sides = [
            trials.planned(name, condition.name) for name in (question.baseline, question.repair)
        ]
        for scene in places:
            ref = trials.scenes[scene]
            for at, seed in enumerate(trials.seeds):
                rows: list[int] = [int(side[at, scene]) for side in sides]
                if max(rows) < 0:
                    continue
                baseline, repair = (trials.outcome(r, ref.id) if r >= 0 else None for r in rows)
                about = (condition.name, seed, ref.id, ref.index, ref.topology)
                pairs.append(Pair(*about, baseline, repair))
    order = {condition.name: place for place, condition in enumerate(result.conditions)}
    return tuple(sorted(pairs, key=lambda p: (order[p.condition], p.topology, p.index, p.seed)))


def is_sample(trials: Trials) -> bool:
    """Return whether pages show some of the scenes for all of them."""
    return len(trials.scenes) > MOST_SCENES


def counts(trials: Trials, result: AuditResult, condition: str) -> dict[PairKind, int]:
    """Return how many of all pairs under a condition ended in each way."""
    question = result.question
    baseline, repair = (Group(name, condition) for name in (question.baseline, question.repair))
    pairs = pair(trials, baseline, repair)
    old, new = (success.T == 1.0 for success in pairs.success)
    masks = {
        PairKind.BOTH: old & new,
        PairKind.REPAIR_ONLY: ~old & new,
        PairKind.BASELINE_ONLY: old & ~new,
        PairKind.NEITHER: ~old & ~new,
    }
    ended = {kind: int((where & ~pairs.void).sum()) for kind, where in masks.items()}
    return {**ended, PairKind.VOID: int(pairs.void.sum())}


def by_scene(pairs: Iterable[Pair]) -> dict[tuple[str, int], dict[str, Pair]]:
    """Return the pairs by scene and seed, in each by condition."""
    groups: dict[tuple[str, int], dict[str, Pair]] = {}
    for member in pairs:
        groups.setdefault((member.scene, member.seed), {})[member.condition] = member
    return groups


def choose(
    result: AuditResult, pairs: Sequence[Pair], recorded: Collection[At] = ()
) -> tuple[At, ...]:
    """Return up to six scenes with their seeds by the rule at the top.

    Of scenes that go alike those that a run has `recorded` come first: its examples stay.
    """
    patterns, index = _patterns(pairs), {(pair.scene, pair.seed): pair.index for pair in pairs}
    away = _away(pairs, patterns)
    counts = Counter(patterns.values())
    signs = {effect.condition: effect.sign for effect in result.effects if effect.leads}
    variants = {PairKind.REPAIR_ONLY: 1, PairKind.BASELINE_ONLY: -1}

    def order(at: At) -> tuple[float, ...]:
        pattern = patterns[at]
        shown = {
            condition: signs.get(condition, 0) * variants.get(kind, 0)
            for condition, kind in pattern
        }
        reversals = sum(
            change.turn == "reversal" and shown.get(change.isolated) == shown.get(SHARED) == 1
            for change in result.changes
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
            if len(chosen) < MOST_EXAMPLES and not shown and not seen:
                chosen.append(at)
    return tuple(at for at in ranked if at in chosen)


def alike(pairs: Sequence[Pair]) -> dict[At, tuple[int, bool]]:
    """Return for each scene and seed the number that go like it, itself included, and whether it is
    typical of them: some end apart at other times, and it does at the median."""
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
    medians = {pattern: median_low(seconds) for pattern, seconds in times.items()}
    return {at: abs(parted[at] - medians[pattern]) for at, pattern in patterns.items()}


def _parted_s(pairs: Mapping[str, Pair]) -> float:
    """Return when the pairs of a scene that end differently have parted, summed; of all pairs where
    none does. Other tools need not say times: these count as none."""
    apart = [pair for pair in pairs.values() if pair.sign] or list(pairs.values())
    trials = ((trial for trial in (pair.baseline, pair.repair) if trial) for pair in apart)
    times = ((t.time_s for t in both if not math.isnan(t.time_s)) for both in trials)
    return sum(min(known, default=0.0) for known in times)


def _patterns(pairs: Sequence[Pair]) -> dict[At, Pattern]:
    """Return who succeeded, condition by condition, in every scene and seed of complete pairs."""
    return {
        at: tuple((condition, pair.kind) for condition, pair in group.items())
        for at, group in by_scene(pairs).items()
        if not any(pair.kind is PairKind.VOID for pair in group.values())
    }
