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
from dataclasses import asdict, dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.record import SHARED, DecisionRecord, Question
from faultpath.report import wording
from faultpath.report.inputs import Traces
from faultpath.report.pairing import Kind, Pair
from faultpath.store import TrialAddress
from faultpath.trials import FloorPlan, Outcome

Track: TypeAlias = NDArray[np.float32]
"""Positions at control steps, `[T, 3]`, metres."""

PARTING_M = 0.5
_DISTANCE = "terminal_distance_m"
"""The metric that ranks scenes, where a system has it."""
_MOST = 6
_FARTHEST_M = 1e6
"""Beyond this a position is no longer drawn where it was: in centimetres it must stay a number."""


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


def choose(record: DecisionRecord, traces: Traces, pairs: Sequence[Pair]) -> tuple[Showing, ...]:
    """Return up to six showings by the rule at the top of this file."""
    ranked = sorted(_showings(record.question, traces, pairs), key=_order)
    chosen: list[Showing] = []
    patterns: set[tuple[int, ...]] = set()
    scenes: set[str] = set()
    for only_new_patterns in (True, False):
        for showing in ranked:
            scene = showing.any_pair.scene
            seen = showing.pattern in patterns and only_new_patterns
            if len(chosen) == _MOST or scene in scenes or seen:
                continue
            chosen.append(showing)
            patterns.add(showing.pattern)
            scenes.add(scene)
    return tuple(sorted(chosen, key=_order))


def viewer_data(
    record: DecisionRecord,
    traces: Traces,
    plans: Mapping[str, FloorPlan],
    pairs: Sequence[Pair],
) -> dict[str, Any] | None:
    """Return what `choose` does as plain data for the page's scripts; `None` for nothing."""
    asked, chosen = record.question, choose(record, traces, pairs)
    if not chosen:
        return None
    return {
        "dt_s": traces.dt_s,
        "parting_m": PARTING_M,
        "baseline": asked.baseline,
        "repair": asked.repair,
        "paths": [{"name": path.name, "title": path.title} for path in record.paths],
        "scenes": [_scene_shown(asked, traces, plans, showing) for showing in chosen],
    }


def parting_step(a: Track, b: Track) -> int | None:
    """Return the first step at which two tracks are more than `PARTING_M` apart, if any."""
    steps = min(len(a), len(b))
    apart = np.linalg.norm(a[:steps] - b[:steps], axis=1) > PARTING_M
    return int(np.argmax(apart)) if apart.any() else None


def _showings(asked: Question, traces: Traces, pairs: Sequence[Pair]) -> Iterator[Showing]:
    groups: dict[tuple[str, int], dict[str, Pair]] = {}
    for pair in pairs:
        tracks = _tracks(asked, traces, pair)
        if pair.kind not in (Kind.VOID, Kind.LEFT_OUT) and all(map(len, tracks)):
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
        distance
        for trial in (pair.baseline, pair.repair)
        if trial is not None and (distance := trial.metrics.get(_DISTANCE)) is not None
    ]
    return abs(ends[0] - ends[1]) if len(ends) == 2 else 0.0


def _tracks(asked: Question, traces: Traces, pair: Pair) -> list[Track]:
    """Return the tracks of baseline and repair; what left none has no row."""
    at = (pair.path, pair.seed, pair.scene)
    none = np.empty((0, 3), np.float32)
    arms = (asked.baseline, asked.repair)
    return [traces.positions.get(TrialAddress(arm, *at), none) for arm in arms]


_WHY = (
    "In this scene one arm alone succeeds with the fault shared, the other alone on another path.",
    "In this scene one arm alone succeeds on one path, and the other alone on another.",
    "In this scene only one arm succeeds with the fault shared.",
    "In this scene only one arm succeeds on at least one path.",
    "In this scene both arms end alike on every path; how far from the goal differs most.",
)


def _scene_shown(
    asked: Question, traces: Traces, plans: Mapping[str, FloorPlan], showing: Showing
) -> dict[str, Any]:
    pair = showing.any_pair
    plan = plans.get(pair.scene)
    return {
        "scene": pair.scene,
        "seed": pair.seed,
        "title": plan.title if plan else pair.topology,
        "why": _WHY[showing.rank],
        "plan": None if plan is None else _plan(plan),
        "pairs": [
            _pair_shown(asked, each, *_tracks(asked, traces, each))
            for each in showing.pairs.values()
        ],
    }


def _pair_shown(asked: Question, pair: Pair, baseline: Track, repair: Track) -> dict[str, Any]:
    return {
        "path": pair.path,
        "kind": pair.kind.value,
        "baseline": _arm(asked, pair.baseline, baseline),
        "repair": _arm(asked, pair.repair, repair),
        "parting_step": parting_step(baseline, repair),
    }


def _arm(asked: Question, trial: Outcome | None, track: Track) -> dict[str, Any]:
    assert trial is not None  # a pair without both trials is void and never shown
    held = np.clip(np.nan_to_num(track), -_FARTHEST_M, _FARTHEST_M)
    return {
        "status": trial.status.value,
        "ended": wording.ended(asked, trial.status),
        "time_s": trial.time_s,
        _DISTANCE: trial.metrics.get(_DISTANCE),
        # `[x, y, z, x, y, z, ...]`
        "track_cm": np.rint(100.0 * held).astype(int).ravel().tolist(),
    }


def _plan(plan: FloorPlan) -> dict[str, Any]:
    drawn = asdict(plan)
    del drawn["title"]
    for prism in drawn["prisms"]:
        prism["corners"] = [[round(v, 3) for v in corner] for corner in prism["corners"]]
    return drawn
