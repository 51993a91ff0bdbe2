"""Which scenes the viewer begins with, and what goes on in them.

A scene with one seed shows who succeeded on each path: its pattern. Patterns come first that show
the most detected reversals, then those that show the most decided effects, less what they
contradict, then those that more scenes have. Of each of the first six patterns the scene is shown
that ended as most did, then the one with the lowest index; places left over are filled in the same
order. They are examples, not a sample.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TypeAlias

from faultpath.decisions import SHARED, DecisionRecord, Question
from faultpath.decisions.wording import capital, series, where
from faultpath.report.inputs import Traces
from faultpath.report.pairing import Kind, Pair, by_scene
from faultpath.trials.store import TrialAddress

At: TypeAlias = tuple[str, int]
"""A scene and a seed."""
Pattern: TypeAlias = tuple[tuple[str, Kind], ...]
"""Who succeeded, path by path."""

_MOST = 6


def choose(record: DecisionRecord, traces: Traces, pairs: Sequence[Pair]) -> tuple[At, ...]:
    """Return up to six scenes with their seeds by the rule at the top; each has its tracks."""
    asked, patterns = record.question, _patterns(pairs)
    counts, groups = Counter(patterns.values()), by_scene(pairs)
    ends = {
        at: tuple(
            t and t.status for pair in groups[at].values() for t in (pair.baseline, pair.repair)
        )
        for at in patterns
    }
    alike = Counter(ends.values())
    signs = {effect.path: effect.sign for effect in record.effects if effect.leads}
    arms = {Kind.REPAIR_ONLY: 1, Kind.BASELINE_ONLY: -1}

    def order(at: At) -> tuple[int, ...]:
        pattern = patterns[at]
        shown = {path: signs.get(path, 0) * arms.get(kind, 0) for path, kind in pattern}
        reversals = sum(
            change.turn == "reversal"
            and shown.get(change.isolated) == shown.get(change.shared) == 1
            for change in record.changes
        )
        return -reversals, -sum(shown.values()), -counts[pattern]

    def has_tracks(at: At) -> bool:
        return not traces.positions or all(
            len(traces.positions.get(TrialAddress(arm, pair.path, pair.seed, pair.scene), ()))
            for pair in groups[at].values()
            for arm in (asked.baseline, asked.repair)
        )

    by_index = sorted(patterns, key=lambda at: (next(iter(groups[at].values())).index, at[1]))
    # A stable sort: patterns stand in the order of the first scene that has them.
    first = {pattern: n for n, pattern in enumerate(dict.fromkeys(patterns[at] for at in by_index))}
    ranked = sorted(by_index, key=lambda at: (*order(at), first[patterns[at]], -alike[ends[at]]))
    ranked = [at for at in ranked if has_tracks(at)]
    chosen: list[At] = []
    for only_new_patterns in (True, False):
        for at in ranked:
            seen = only_new_patterns and patterns[at] in (patterns[each] for each in chosen)
            shown = at[0] in (scene for scene, _ in chosen)
            if len(chosen) < _MOST and not shown and not seen:
                chosen.append(at)
    return tuple(at for at in ranked if at in chosen)


def captions(record: DecisionRecord, pairs: Sequence[Pair]) -> dict[At, str]:
    """Say of each scene and seed who succeeded there, and in how many it went so.

    It is told of the paths on which something is decided and the primary one; of all where nothing
    is.
    """
    asked, patterns = record.question, _patterns(pairs)
    named = {effect.path for effect in record.effects if effect.leads}
    for change in record.changes:
        named |= {change.isolated, change.shared} if change.turn != "none" else set[str]()
    named |= {asked.primary or SHARED} if named else {path.name for path in record.paths}
    told = {at: tuple(one for one in whole if one[0] in named) for at, whole in patterns.items()}
    like = Counter(told.values())
    of = f"{len(patterns)} scenes"
    if len(asked.seeds) > 1:
        scenes = len({scene for scene, _ in patterns})
        of = f"{len(patterns)} ({scenes} scenes, {len(asked.seeds)} seeds)"
    found: dict[At, str] = {}
    for at, pattern in told.items():
        words = _who(asked, dict(pattern), every=len(pattern) == len(patterns[at]))
        goes = "goes" if like[pattern] == 1 else "go"
        count = f" {like[pattern]} of {of} {goes} like this one." if len(patterns) > 1 else ""
        found[at] = f"{words}{count}"
    return found


def _patterns(pairs: Sequence[Pair]) -> dict[At, Pattern]:
    """Return the pattern of every scene and seed without a void pair."""
    out = (Kind.VOID, Kind.LEFT_OUT)
    return {
        at: tuple((path, pair.kind) for path, pair in group.items())
        for at, group in by_scene(pairs).items()
        if not any(pair.kind in out for pair in group.values())
    }


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
