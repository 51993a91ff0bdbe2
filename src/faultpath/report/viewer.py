"""The few scenes whose flights are shown, and what the page's scripts need to draw them.

How scenes are chosen. A *showing* is one scene with one seed, and its *pattern* is who alone
succeeded there, path by path. Scenes with a void pair and flights without a track are left out. The
rest is ranked: first those where the arm that alone succeeds under the shared fault is not the one
that alone succeeds on another path; then those where that arm changes between other paths; then
those where one arm alone succeeds under the shared fault; then those where one does on any path;
then the others. Within a rank the largest difference in terminal distance comes first, then the
scene index and the seed. From that list the first showing of every pattern is taken, then the list
is filled up in order, never with a scene twice. They are examples, not a sample.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, TypedDict

import numpy as np
from numpy.typing import NDArray

from faultpath.record import SHARED, DecisionRecord, Question
from faultpath.report import wording
from faultpath.report.inputs import Traces
from faultpath.report.pairing import Kind, Pair, Trial
from faultpath.trials.floorplan import FloorPlan

PARTING_M = 0.5
_FARTHEST_M = 1e6
"""Beyond this a position is no longer drawn where it was: in centimetres it must stay a number."""


class Audited(Protocol):
    """An audit with its flights."""

    @property
    def record(self) -> DecisionRecord:
        """What was asked and decided."""
        ...

    @property
    def traces(self) -> Traces:
        """Flights; trials may be missing."""
        ...

    @property
    def plans(self) -> Mapping[str, FloorPlan]:
        """By scene id; scenes without one are drawn without obstacles."""
        ...


@dataclass(frozen=True)
class Showing:
    """One scene with one seed, all its pairs by path."""

    pairs: dict[str, Pair]
    rank: int
    gap_m: float

    @property
    def any_pair(self) -> Pair:
        """Return one of the pairs, for what they all share."""
        return next(iter(self.pairs.values()))

    @property
    def pattern(self) -> tuple[int, ...]:
        """Who alone succeeded, path by path: +1 the repair, -1 the baseline, 0 neither alone."""
        return tuple(pair.sign for pair in self.pairs.values())


class ArmShown(TypedDict):
    """One flight: positions in centimetres, `[x, y, z, x, y, z, ...]`."""

    status: str
    ended: str
    time_s: float | None
    terminal_distance_m: float | None
    track_cm: list[int]


class PairShown(TypedDict):
    """Both flights on one path and the step at which they first part."""

    path: str
    kind: str
    baseline: ArmShown
    repair: ArmShown
    parting_step: int | None


class SceneShown(TypedDict):
    """One scene in the viewer."""

    scene: str
    seed: int
    title: str
    why: str
    plan: dict[str, object] | None
    pairs: list[PairShown]


class ViewerData(TypedDict):
    """Everything the viewer's scripts get."""

    dt_s: float
    parting_m: float
    baseline: str
    repair: str
    paths: list[dict[str, str]]
    scenes: list[SceneShown]


def choose(source: Audited, pairs: Sequence[Pair], count: int = 6) -> tuple[Showing, ...]:
    """Return up to `count` showings by the rule at the top of this file."""
    ranked = sorted(_showings(source, pairs), key=_order)
    chosen: list[Showing] = []
    patterns: set[tuple[int, ...]] = set()
    scenes: set[str] = set()
    for only_new_patterns in (True, False):
        for showing in ranked:
            scene = showing.any_pair.scene
            seen = showing.pattern in patterns and only_new_patterns
            if len(chosen) == count or scene in scenes or seen:
                continue
            chosen.append(showing)
            patterns.add(showing.pattern)
            scenes.add(scene)
    return tuple(sorted(chosen, key=_order))


def viewer_data(source: Audited, chosen: Sequence[Showing]) -> ViewerData:
    """Return the chosen showings as plain data for the page's scripts."""
    asked = source.record.question
    return {
        "dt_s": source.traces.dt_s,
        "parting_m": PARTING_M,
        "baseline": asked.baseline,
        "repair": asked.repair,
        "paths": [{"name": p.name, "title": p.title} for p in source.record.paths],
        "scenes": [_scene_shown(source, showing) for showing in chosen],
    }


def parting_step(a: NDArray[np.float32], b: NDArray[np.float32]) -> int | None:
    """Return the first step at which two tracks are more than `PARTING_M` apart, if any."""
    steps = min(len(a), len(b))
    apart = np.linalg.norm(a[:steps] - b[:steps], axis=1) > PARTING_M
    return int(np.argmax(apart)) if apart.any() else None


def _showings(source: Audited, pairs: Sequence[Pair]) -> Iterator[Showing]:
    groups: dict[tuple[str, int], dict[str, Pair]] = {}
    for pair in pairs:
        if pair.kind not in (Kind.VOID, Kind.LEFT_OUT) and _flown(source, pair):
            groups.setdefault((pair.scene, pair.seed), {})[pair.path] = pair
    for group in groups.values():
        yield Showing(group, _rank(group), max(map(_distance_gap, group.values())))


def _rank(group: dict[str, Pair]) -> int:
    signs = {path: pair.sign for path, pair in group.items()}
    shared = signs.get(SHARED, 0)
    if shared and -shared in signs.values():
        return 0
    if {1, -1} <= set(signs.values()):
        return 1
    if shared:
        return 2
    return 3 if any(signs.values()) else 4


def _order(showing: Showing) -> tuple[int, float, int, int]:
    pair = showing.any_pair
    return showing.rank, -showing.gap_m, pair.index, pair.seed


def _distance_gap(pair: Pair) -> float:
    ends = [
        trial.terminal_distance_m
        for trial in (pair.baseline, pair.repair)
        if trial is not None and trial.terminal_distance_m is not None
    ]
    return abs(ends[0] - ends[1]) if len(ends) == 2 else 0.0


def _flown(source: Audited, pair: Pair) -> bool:
    asked = source.record.question
    return all(
        len(source.traces.get((v, pair.path, pair.seed, pair.scene), ())) > 0
        for v in (asked.baseline, asked.repair)
    )


_WHY = (
    "In this scene one arm alone succeeds with the fault shared, the other alone on another path.",
    "In this scene one arm alone succeeds on one path, and the other alone on another.",
    "In this scene only one arm succeeds with the fault shared.",
    "In this scene only one arm succeeds on at least one path.",
    "In this scene both arms end alike on every path; how far from the goal differs most.",
)


def _scene_shown(source: Audited, showing: Showing) -> SceneShown:
    pair = showing.any_pair
    plan = source.plans.get(pair.scene)
    return {
        "scene": pair.scene,
        "seed": pair.seed,
        "title": plan.title if plan else pair.topology,
        "why": _WHY[showing.rank],
        "plan": None if plan is None else _plan(plan),
        "pairs": [_pair_shown(source, p) for p in showing.pairs.values()],
    }


def _pair_shown(source: Audited, pair: Pair) -> PairShown:
    asked = source.record.question
    place = (pair.path, pair.seed, pair.scene)
    baseline = source.traces[asked.baseline, *place]
    repair = source.traces[asked.repair, *place]
    return {
        "path": pair.path,
        "kind": pair.kind.value,
        "baseline": _arm(pair.baseline, baseline, asked),
        "repair": _arm(pair.repair, repair, asked),
        "parting_step": parting_step(baseline, repair),
    }


def _arm(trial: Trial | None, track: NDArray[np.float32], asked: Question) -> ArmShown:
    assert trial is not None  # a pair without both trials is void and never shown
    held = np.clip(np.nan_to_num(track), -_FARTHEST_M, _FARTHEST_M)
    centimetres: list[int] = np.rint(100.0 * held).astype(int).ravel().tolist()
    return {
        "status": trial.status,
        "ended": wording.ended(asked, trial.status),
        "time_s": trial.time_s,
        "terminal_distance_m": trial.terminal_distance_m,
        "track_cm": centimetres,
    }


def _plan(plan: FloorPlan) -> dict[str, object]:
    return {
        "low": plan.low,
        "high": plan.high,
        "start": plan.start,
        "goal": plan.goal,
        "prisms": [
            {
                "corners": [[round(v, 3) for v in c] for c in p.corners],
                "bottom": p.bottom,
                "top": p.top,
            }
            for p in plan.prisms
        ],
        "pillars": [
            {"x": p.x, "y": p.y, "radius": p.radius, "bottom": p.bottom, "top": p.top}
            for p in plan.pillars
        ],
    }
