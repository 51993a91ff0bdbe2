"""The outcome table read as pairs: baseline and repair in the same scene, path and seed."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import StrEnum

from faultpath.record.model import DecisionRecord
from faultpath.trials import Outcome, OutcomeTable, Status, TrialRow


class Kind(StrEnum):
    """What a pair says."""

    BOTH = "both"
    REPAIR_ONLY = "repair-only"
    BASELINE_ONLY = "baseline-only"
    NEITHER = "neither"
    LEFT_OUT = "left-out"
    VOID = "void"


WORDS = {
    Kind.BOTH: "both succeed",
    Kind.REPAIR_ONLY: "only the repair succeeds",
    Kind.BASELINE_ONLY: "only the baseline succeeds",
    Kind.NEITHER: "neither succeeds",
    Kind.LEFT_OUT: "left out: a pair of this scene is void on another path or seed",
    Kind.VOID: "void: a trial failed to run, or the two are not the same trial",
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
    left_out: bool = False
    """Another pair of the scene is void, so no effect counts the scene."""

    @property
    def void_reason(self) -> str | None:
        """Why the pair says nothing, or `None` for a pair that counts."""
        for arm, trial in (("baseline", self.baseline), ("repair", self.repair)):
            if trial is None:
                return f"the {arm} did not run"
            if trial.failed:
                return f"the {arm} failed: {trial.error or 'no message was kept'}"
        if self.baseline and self.repair and _met(self.baseline) != _met(self.repair):
            return "the two arms differ in initial state, disturbance or planner noise"
        return None

    @property
    def kind(self) -> Kind:
        """What the pair says."""
        if self.void_reason is not None or self.baseline is None or self.repair is None:
            return Kind.VOID
        if self.left_out:
            return Kind.LEFT_OUT
        match (self.baseline.status is Status.SUCCESS, self.repair.status is Status.SUCCESS):
            case (True, True):
                return Kind.BOTH
            case (False, True):
                return Kind.REPAIR_ONLY
            case (True, False):
                return Kind.BASELINE_ONLY
            case _:
                return Kind.NEITHER

    @property
    def sign(self) -> int:
        """+1 where only the repair succeeds, -1 where only the baseline does, else 0."""
        return {Kind.REPAIR_ONLY: 1, Kind.BASELINE_ONLY: -1}.get(self.kind, 0)


def read_pairs(outcomes: OutcomeTable, record: DecisionRecord) -> tuple[Pair, ...]:
    """Return every pair of the record's arms, ordered by path, topology, scene index and seed."""
    asked, compared = record.question, {effect.path for effect in record.effects}
    named = [path.name for path in record.paths]
    trials: dict[tuple[str, str, int, str], Outcome] = {}
    places: dict[tuple[str, int, str], TrialRow] = {}
    for row in outcomes.rows:
        if row.variant in (asked.baseline, asked.repair) and row.path in named:
            place = (row.path, row.seed, row.outcome.scene)
            trials[row.variant, *place] = row.outcome
            places.setdefault(place, row)
    paths = list(dict.fromkeys(path for path, _, _ in places))
    pairs = [
        Pair(
            path=row.path,
            seed=row.seed,
            scene=row.outcome.scene,
            index=row.scene_index,
            topology=row.topology,
            baseline=trials.get((asked.baseline, *place)),
            repair=trials.get((asked.repair, *place)),
        )
        for place, row in places.items()
    ]
    void = {p.scene for p in pairs if p.kind is Kind.VOID and p.path in compared}
    pairs = [replace(pair, left_out=pair.scene in void) for pair in pairs]
    return tuple(sorted(pairs, key=lambda p: (paths.index(p.path), p.topology, p.index, p.seed)))


def by_scene(pairs: Iterable[Pair]) -> dict[tuple[str, int], dict[str, Pair]]:
    """Return the pairs by scene and seed, in each by path."""
    groups: dict[tuple[str, int], dict[str, Pair]] = {}
    for pair in pairs:
        groups.setdefault((pair.scene, pair.seed), {})[pair.path] = pair
    return groups


def _met(outcome: Outcome) -> tuple[str, str, str]:
    return outcome.initial_hash, outcome.disturbance_hash, outcome.planner_noise_hash
