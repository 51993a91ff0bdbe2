"""Pairs of trials, both variants in the same scene, condition and seed, as pages and examples show
them."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np

from faultpath.analyses.model import AuditResult
from faultpath.run.pairing import Group, pair, unlike
from faultpath.run.trials import Trials
from faultpath.system.outcome import Outcome, Status

MOST_SCENES = 1000
"""So many scenes a page shows one by one; of more it shows these and counts all."""


class PairKind(StrEnum):
    """How the two trials of a pair ended."""

    BOTH = "both"
    REPAIR_ONLY = "repair-only"
    BASELINE_ONLY = "baseline-only"
    NEITHER = "neither"
    VOID = "void"


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
        """Why the pair says nothing, or `None` for a pair that counts."""
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


def read_pairs(trials: Trials, record: AuditResult) -> tuple[Pair, ...]:
    """Return the pairs that a page shows, ordered by condition, topology, scene index and seed.

    These are all pairs of the record's versions, or those of `MOST_SCENES` scenes that lie evenly
    among more.
    """
    question = record.question
    places = range(len(trials.scenes))
    if is_sample(trials):
        places = np.linspace(0, len(trials.scenes) - 1, MOST_SCENES).astype(int).tolist()
    pairs: list[Pair] = []
    for condition in record.conditions:
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
    order = {condition.name: place for place, condition in enumerate(record.conditions)}
    return tuple(sorted(pairs, key=lambda p: (order[p.condition], p.topology, p.index, p.seed)))


def is_sample(trials: Trials) -> bool:
    """Return whether pages show some of the scenes for all of them."""
    return len(trials.scenes) > MOST_SCENES


def counts(trials: Trials, record: AuditResult, condition: str) -> dict[PairKind, int]:
    """Return how many of all pairs under a condition ended in each way."""
    question = record.question
    baseline, repair = (Group(name, condition) for name in (question.baseline, question.repair))
    pairs = pair(trials, baseline, repair)
    old, new = (success.T == 1.0 for success in pairs.success)
    of = {
        PairKind.BOTH: old & new,
        PairKind.REPAIR_ONLY: ~old & new,
        PairKind.BASELINE_ONLY: old & ~new,
        PairKind.NEITHER: ~old & ~new,
    }
    ended = {kind: int((where & ~pairs.void).sum()) for kind, where in of.items()}
    return {**ended, PairKind.VOID: int(pairs.void.sum())}


def by_scene(pairs: Iterable[Pair]) -> dict[tuple[str, int], dict[str, Pair]]:
    """Return the pairs by scene and seed, in each by condition."""
    groups: dict[tuple[str, int], dict[str, Pair]] = {}
    for member in pairs:
        groups.setdefault((member.scene, member.seed), {})[member.condition] = member
    return groups
