"""Pairs of trials, both arms in the same scene, path and seed, as pages and examples show them."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from faultpath.decisions.model import DecisionRecord
from faultpath.trials import Outcome, Status, Trial, Trials
from faultpath.trials.pairing import unlike


class PairKind(StrEnum):
    """How the two trials of a pair ended."""

    BOTH = "both"
    REPAIR_ONLY = "repair-only"
    BASELINE_ONLY = "baseline-only"
    NEITHER = "neither"
    VOID = "void"

    @property
    def short(self) -> str:
        """In two words."""
        return self.value.replace("-", " ")


WORDS = {
    PairKind.BOTH: "both succeed",
    PairKind.REPAIR_ONLY: "only the repair succeeds",
    PairKind.BASELINE_ONLY: "only the baseline succeeds",
    PairKind.NEITHER: "neither succeeds",
    PairKind.VOID: "void: a trial failed to run, or the two are not the same trial",
}


@dataclass(frozen=True)
class Pair:
    """Both arms in one scene on one path with one seed; an arm is `None` when it never ran."""

    path: str
    seed: int
    scene: str
    index: int
    topology: str
    baseline: Outcome | None
    repair: Outcome | None

    @property
    def void_reason(self) -> str | None:
        """Why the pair says nothing, or `None` for a pair that counts."""
        for arm, trial in (("baseline", self.baseline), ("repair", self.repair)):
            if trial is None:
                return f"the {arm} did not run"
            if trial.failed:
                return f"the {arm} failed: {trial.error or 'no message was kept'}"
        if self.baseline and self.repair and unlike(self.baseline, self.repair):
            return "the two trials differ in initial state, disturbance or planner noise"
        return None

    @property
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


def read_pairs(outcomes: Trials, record: DecisionRecord) -> tuple[Pair, ...]:
    """Return every pair of the record's arms, ordered by path, topology, scene index and seed."""
    question = record.question
    named = {path.name for path in record.paths}
    trials: dict[tuple[str, str, int, str], Outcome] = {}
    places: dict[tuple[str, int, str], Trial] = {}
    for trial in outcomes:
        if trial.variant in (question.baseline, question.repair) and trial.condition in named:
            place = (trial.condition, trial.seed, trial.outcome.scene)
            trials[trial.variant, *place] = trial.outcome
            places.setdefault(place, trial)
    paths = list(dict.fromkeys(path for path, _, _ in places))
    pairs = [
        Pair(
            path=trial.condition,
            seed=trial.seed,
            scene=trial.outcome.scene,
            index=trial.scene_index,
            topology=trial.topology,
            baseline=trials.get((question.baseline, *place)),
            repair=trials.get((question.repair, *place)),
        )
        for place, trial in places.items()
    ]
    return tuple(sorted(pairs, key=lambda p: (paths.index(p.path), p.topology, p.index, p.seed)))


def by_scene(pairs: Iterable[Pair]) -> dict[tuple[str, int], dict[str, Pair]]:
    """Return the pairs by scene and seed, in each by path."""
    groups: dict[tuple[str, int], dict[str, Pair]] = {}
    for pair in pairs:
        groups.setdefault((pair.scene, pair.seed), {})[pair.path] = pair
    return groups
