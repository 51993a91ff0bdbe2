"""Which scenes the viewer and the film begin with, and what goes on in them.

How scenes are chosen. A *showing* is one scene with one seed, and its *pattern* is who succeeded
there, path by path. Patterns are ranked by how well they agree with what the audit announced; where
that is equal, or nothing was announced, the one that more showings have comes first, then the one
with the lowest scene index. Of one pattern come first those whose trials ended as those of most, in
a crash or out of time, then the lowest index. One scene of each of the first six patterns is shown;
places left over are filled in this order, never with a scene twice. They are examples, not a
sample.

What is announced: each decided difference that may lead a headline, and each detected change from
an isolated fault to the shared one. A pattern shows a difference where only the arm that is ahead
succeeds, and contradicts it where only the other does. First come patterns that show the most
reversals, on both their paths; then those that show the most of what was announced, less what they
contradict; then those in which both arms end alike on the most other paths, and both succeed there.
"""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.record import SHARED, DecisionRecord, Question
from faultpath.record.wording import capital, series, where
from faultpath.report.inputs import Traces
from faultpath.report.pairing import Kind, Pair, by_scene
from faultpath.store import TrialAddress
from faultpath.trials import Status

Track: TypeAlias = NDArray[np.float32]
"""Positions at control steps, `[T, 3]`, metres."""

PARTING_M = 0.5
_MOST = 6
_ALIKE = (Kind.BOTH, Kind.NEITHER)


@dataclass(frozen=True)
class Showing:
    """One scene with one seed, all its pairs by path."""

    pairs: Mapping[str, Pair]

    @property
    def any_pair(self) -> Pair:
        """Return one of the pairs, for what they all share."""
        return next(iter(self.pairs.values()))

    @property
    def pattern(self) -> tuple[tuple[str, Kind], ...]:
        """Who succeeded, path by path."""
        return self.on(self.pairs)

    @property
    def ends(self) -> tuple[tuple[str, Status | None], ...]:
        """How the trials ended, path by path, the baseline's before the repair's."""
        return tuple(
            (path, trial.status if trial else None)
            for path, pair in self.pairs.items()
            for trial in (pair.baseline, pair.repair)
        )

    def on(self, paths: Iterable[str]) -> tuple[tuple[str, Kind], ...]:
        """Return who succeeded on some paths."""
        return tuple((path, self.pairs[path].kind) for path in paths if path in self.pairs)


def choose(record: DecisionRecord, traces: Traces, pairs: Sequence[Pair]) -> tuple[Showing, ...]:
    """Return up to six showings by the rule at the top of this file; each has its tracks."""
    ranked = [
        showing
        for showing in _ranked(record, pairs)
        if not traces.positions
        or all(
            len(t) for p in showing.pairs.values() for t in tracks_of(record.question, traces, p)
        )
    ]
    chosen: list[Showing] = []
    for only_new_patterns in (True, False):
        for showing in ranked:
            scene = showing.any_pair.scene
            seen = only_new_patterns and showing.pattern in (each.pattern for each in chosen)
            shown = scene in (each.any_pair.scene for each in chosen)
            if len(chosen) < _MOST and not shown and not seen:
                chosen.append(showing)
    return tuple(showing for showing in ranked if showing in chosen)


def captions(record: DecisionRecord, pairs: Sequence[Pair]) -> dict[tuple[str, int], str]:
    """Say of each scene and seed who succeeded there, and in how many it went so.

    It is told of the paths that were announced and the primary one; of all where none was.
    """
    asked, showings = record.question, _showings(pairs)
    named = _announced(record)
    named |= {asked.primary or SHARED} if named else {path.name for path in record.paths}
    told = [path.name for path in record.paths if path.name in named]
    like = Counter(showing.on(told) for showing in showings)
    everywhere = Counter(showing.pattern for showing in showings)
    of = f"{len(showings)} scenes"
    if len(asked.seeds) > 1:
        scenes = len({showing.any_pair.scene for showing in showings})
        of = f"{len(showings)} ({scenes} scenes, {len(asked.seeds)} seeds)"

    def said(showing: Showing) -> str:
        words = _who(asked, dict(showing.on(told)), every=len(told) == len(showing.pairs))
        count, whole = like[showing.on(told)], everywhere[showing.pattern]
        if len(showings) == 1:
            return words
        goes = "goes" if count == 1 else "go"
        more = f" there, {whole} on every path" if whole < count else ""
        return f"{words} {count} of {of} {goes} like this one{more}."

    return {(s.any_pair.scene, s.any_pair.seed): said(s) for s in showings}


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


def _showings(pairs: Sequence[Pair]) -> list[Showing]:
    out = (Kind.VOID, Kind.LEFT_OUT)
    return [
        Showing(group)
        for group in by_scene(pairs).values()
        if not any(pair.kind in out for pair in group.values())
    ]


def _announced(record: DecisionRecord) -> set[str]:
    changes = [change for change in record.changes if change.turn != "none"]
    leading = {effect.path for effect in record.effects if effect.leads}
    return leading.union(*({change.isolated, change.shared} for change in changes))


def _ranked(record: DecisionRecord, pairs: Sequence[Pair]) -> list[Showing]:
    showings = sorted(_showings(pairs), key=lambda s: (s.any_pair.index, s.any_pair.seed))
    counts = Counter(showing.pattern for showing in showings)
    alike = Counter(showing.ends for showing in showings)
    # A stable sort: patterns stand in the order of the first scene that has them.
    first = {pattern: place for place, pattern in enumerate(counts)}

    def order(showing: Showing) -> tuple[int, ...]:
        agrees = _agreement(record, dict(showing.pattern))
        by_pattern = -counts[showing.pattern], first[showing.pattern]
        return *(-each for each in agrees), *by_pattern, -alike[showing.ends]

    return sorted(showings, key=order)


def _agreement(record: DecisionRecord, kinds: Mapping[str, Kind]) -> tuple[int, ...]:
    if not _announced(record):
        return ()
    signs = {Kind.REPAIR_ONLY: 1, Kind.BASELINE_ONLY: -1}
    ahead = {path: signs.get(kind, 0) for path, kind in kinds.items()}
    leading = {effect.path: effect.sign for effect in record.effects if effect.leads}
    shown = {path: sign * ahead.get(path, 0) for path, sign in leading.items()}
    reversals, net = 0, sum(shown.values())
    for change in record.changes:
        if change.turn != "none":
            differs = ahead.get(change.shared, 0) - ahead.get(change.isolated, 0)
            net += int(np.sign(change.sign * differs))
        if change.turn == "reversal":
            reversals += shown.get(change.isolated) == shown.get(change.shared) == 1
    others = [kind for path, kind in kinds.items() if path not in leading]
    return reversals, net, sum(kind in _ALIKE for kind in others), others.count(Kind.BOTH)


def _who(asked: Question, kinds: Mapping[str, Kind], every: bool) -> str:
    """Say who succeeded on these paths, which may be `every` one that there is."""
    words = {
        Kind.REPAIR_ONLY: f"only {asked.repair} succeeds",
        Kind.BASELINE_ONLY: f"only {asked.baseline} succeeds",
        Kind.BOTH: "both succeed",
        Kind.NEITHER: "neither succeeds",
    }
    found = {kind: [where(p) for p, k in kinds.items() if k is kind] for kind in words}
    if every and len(set(kinds.values())) == 1:
        of = "any" if Kind.NEITHER in kinds.values() else "every"
        found = {kind: [f"on {of} path"] for kind in kinds.values()}
    parts = (f"{words[kind]} {series(places)}" for kind, places in found.items() if places)
    return capital(f"{'; '.join(parts)}.")
