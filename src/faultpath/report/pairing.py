"""The outcome table read as pairs: baseline and repair in the same scene, path and seed."""

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

import pyarrow as pa

from faultpath.record.model import DecisionRecord


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

_HASHES = ("initial_hash", "disturbance_hash", "planner_noise_hash")


@dataclass(frozen=True)
class Trial:
    """The part of an outcome row that pictures need."""

    status: str
    time_s: float | None
    terminal_distance_m: float | None
    hashes: tuple[str, ...]
    error: str | None


@dataclass(frozen=True)
class Pair:
    """Both arms in one scene on one path with one seed; an arm is `None` when it never ran."""

    path: str
    seed: int
    scene: str
    index: int
    topology: str
    baseline: Trial | None
    repair: Trial | None
    left_out: bool = False
    """Another pair of the scene is void, so no effect counts the scene."""

    @property
    def void_reason(self) -> str | None:
        """Why the pair says nothing, or `None` for a pair that counts."""
        for arm, trial in (("baseline", self.baseline), ("repair", self.repair)):
            if trial is None:
                return f"the {arm} did not run"
            if trial.status == "failed":
                return f"the {arm} failed: {trial.error or 'no message was kept'}"
        if self.baseline and self.repair and self.baseline.hashes != self.repair.hashes:
            return "the two arms differ in initial state, disturbance or planner noise"
        return None

    @property
    def kind(self) -> Kind:
        """What the pair says."""
        if self.void_reason is not None or self.baseline is None or self.repair is None:
            return Kind.VOID
        if self.left_out:
            return Kind.LEFT_OUT
        match (self.baseline.status == "success", self.repair.status == "success"):
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


def read_pairs(outcomes: pa.Table, record: DecisionRecord) -> tuple[Pair, ...]:
    """Return every pair of the table, ordered by path, topology, scene index and seed."""
    question = record.question
    compared = {effect.path for effect in record.effects}
    trials: dict[tuple[str, str, int, str], Trial] = {}
    places: dict[tuple[str, int, str], tuple[int, str]] = {}
    rows: list[dict[str, Any]] = outcomes.to_pylist()
    for row in rows:
        place = (row["path"], row["seed"], row["scene"])
        trials[row["variant"], *place] = _trial(row)
        places.setdefault(place, (int(row["scene_index"]), row["topology"] or ""))
    paths = list(dict.fromkeys(path for path, _, _ in places))
    pairs = [
        Pair(
            path=path,
            seed=seed,
            scene=scene,
            index=index,
            topology=topology,
            baseline=trials.get((question.baseline, path, seed, scene)),
            repair=trials.get((question.repair, path, seed, scene)),
        )
        for (path, seed, scene), (index, topology) in places.items()
    ]
    void = {p.scene for p in pairs if p.kind is Kind.VOID and p.path in compared}
    pairs = [replace(pair, left_out=pair.scene in void) for pair in pairs]
    return tuple(sorted(pairs, key=lambda p: (paths.index(p.path), p.topology, p.index, p.seed)))


def _trial(row: dict[str, Any]) -> Trial:
    return Trial(
        status=row["status"],
        time_s=row["time_s"],
        terminal_distance_m=row["terminal_distance_m"],
        hashes=tuple(row[name] for name in _HASHES),
        error=row["error"],
    )
