"""Which scenes the viewer begins with, and why.

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
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.record import SHARED, DecisionRecord, Question
from faultpath.report.inputs import Traces
from faultpath.report.pairing import Kind, Pair, by_scene
from faultpath.store import TrialAddress

Track: TypeAlias = NDArray[np.float32]
"""Positions at control steps, `[T, 3]`, metres."""

PARTING_M = 0.5
DISTANCE = "terminal_distance_m"
"""The metric that ranks scenes, where a system has it."""
_MOST = 6
_WHY = (
    "In this scene one arm alone succeeds with the fault shared, the other alone on another path.",
    "In this scene one arm alone succeeds on one path, and the other alone on another.",
    "In this scene only one arm succeeds with the fault shared.",
    "In this scene only one arm succeeds on at least one path.",
    "In this scene both arms end alike on every path.",
)


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


def parting_step(a: Track, b: Track) -> int | None:
    """Return the first step at which two tracks are more than `PARTING_M` apart, if any."""
    steps = min(len(a), len(b))
    apart = np.linalg.norm(a[:steps] - b[:steps], axis=1) > PARTING_M
    return int(np.argmax(apart)) if apart.any() else None


def track_of(traces: Traces, variant: str, pair: Pair) -> Track:
    """Return the track of an arm of a pair; what left none has no row."""
    address = TrialAddress(variant, pair.path, pair.seed, pair.scene)
    return traces.positions.get(address, np.empty((0, 3), np.float32))


def tracks_of(asked: Question, traces: Traces, pair: Pair) -> list[Track]:
    """Return the tracks of baseline and repair."""
    return [track_of(traces, variant, pair) for variant in (asked.baseline, asked.repair)]


def why(group: Mapping[str, Pair]) -> str:
    """Say who succeeded where in a scene without a void pair."""
    return _WHY[_rank(group)]


def _showings(asked: Question, traces: Traces, pairs: Sequence[Pair]) -> Iterator[Showing]:
    sound = [
        pair
        for pair in pairs
        if pair.kind not in (Kind.VOID, Kind.LEFT_OUT)
        and (not traces.positions or all(map(len, tracks_of(asked, traces, pair))))
    ]
    for group in by_scene(sound).values():
        yield Showing(group, _rank(group), max(map(_distance_gap, group.values())))


def _rank(group: Mapping[str, Pair]) -> int:
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
        if trial is not None and (distance := trial.metrics.get(DISTANCE)) is not None
    ]
    return abs(ends[0] - ends[1]) if len(ends) == 2 else 0.0
