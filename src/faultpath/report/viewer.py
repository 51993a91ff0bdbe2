"""Every trial as the page's scripts need it to draw it again."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faultpath.decisions import SHARED, DecisionRecord, Path, Question, wording
from faultpath.report.inputs import Traces
from faultpath.report.pairing import Pair, by_scene
from faultpath.report.viewer_choice import (
    PARTING_M,
    Track,
    captions,
    choose,
    parting_step,
    tracks_of,
)
from faultpath.report.viewer_hits import hit
from faultpath.report.viewer_packing import Whole, pack
from faultpath.report.viewer_signals import Plot, drawn, in_force, plots
from faultpath.trials import FloorPlan, Outcome, Status
from faultpath.trials.store import TrialAddress
from faultpath.trials.store.signals import Signal, Signals

SCRIPTS = ("flights.js", "viewer.js")
"""Of a page with the viewer, in this order."""

_MOST_WITH_SIGNALS = 12
"""Scenes, with a seed each, whose signals go into a page."""
_ATTITUDE = ("vehicle.attitude", "attitude_estimate", "attitude")
_WIND = ("true_wind", "wind")
"""What is drawn at a vehicle, under the first of these names that it is recorded."""
_FARTHEST_M = 1e6
"""Beyond this a position is no longer drawn where it was: in centimetres it must stay a number."""


@dataclass(frozen=True)
class Viewer:
    """What a page needs of the viewer beside its scripts."""

    paths: tuple[Path, ...]
    space: str
    """`space`: flights are drawn from above and in three dimensions; `line`: their positions lie
    on one axis and are plotted over time; `none`: the system gives no positions."""
    parting_m: float
    shown: frozenset[tuple[str, int]]
    """Scenes and seeds that can be looked at."""
    packed: str
    """All else, for the script."""


def viewer_data(
    record: DecisionRecord,
    traces: Traces,
    plans: Mapping[str, FloorPlan],
    pairs: Sequence[Pair],
    signals: Signals | None = None,
) -> Viewer | None:
    """Return every trial for the page's scripts; `None` where there is nothing to play.

    Left out are scenes without any track and, where no trial has one, those without signals.
    """
    asked = record.question
    space = _space(traces, plans)
    heard = {(at.scene, at.seed) for at in signals or ()}
    groups = {
        at: group
        for at, group in by_scene(pairs).items()
        if (space == "none" and at in heard)
        or any(len(t) for pair in group.values() for t in tracks_of(asked, traces, pair))
    }
    if not groups:
        return None
    chosen = choose(record, traces, pairs)
    kept = _kept(signals or {}, chosen, groups)
    if space == "line":
        kept = _with_positions(kept, traces)
    lines, series = plots(kept), list[Whole]()
    packing = _Packing(asked, traces, plans, kept, lines, captions(record, pairs), series)
    scenes = [packing.scene(group) for group in groups.values()]
    places = {at: place for place, at in enumerate(groups)}
    picked = [at for at in chosen if at in places]
    content = {
        "dt_s": traces.dt_s,
        "parting_m": PARTING_M,
        "space": space,
        "baseline": asked.baseline,
        "repair": asked.repair,
        "paths": [{"name": path.name, "title": path.title} for path in record.paths],
        "picked": [places[at] for at in picked],
        "path": _begin(record, groups[picked[0] if picked else next(iter(groups))]),
        "plots": [plot.told for plot in lines],
        "plans": {name: _plan(plans[name]) for name, _ in groups if name in plans},
        "scenes": scenes,
    }
    return Viewer(record.paths, space, PARTING_M, frozenset(groups), pack(content, series))


def _begin(record: DecisionRecord, first: Mapping[str, Pair]) -> str:
    signs = {effect.path: effect.sign for effect in record.effects if effect.leads}
    apart = [path for path, pair in first.items() if pair.sign and signs.get(path) == pair.sign]
    primary = record.question.primary or SHARED
    return apart[0] if apart and primary not in apart else primary


@dataclass(frozen=True)
class _Packing:
    """Turns trials into what the script reads; tracks and signals go into `series`."""

    asked: Question
    traces: Traces
    plans: Mapping[str, FloorPlan]
    signals: Signals
    plots: tuple[Plot, ...]
    captions: Mapping[tuple[str, int], str]
    series: list[Whole]

    def scene(self, group: Mapping[str, Pair]) -> dict[str, Any]:
        pair = next(iter(group.values()))
        plan = self.plans.get(pair.scene)
        return {
            "scene": pair.scene,
            "seed": pair.seed,
            "title": plan.title if plan else pair.topology,
            "why": self.captions.get((pair.scene, pair.seed), ""),
            "pairs": [self._pair(each) for each in group.values()],
        }

    def _pair(self, pair: Pair) -> dict[str, Any]:
        tracks = tracks_of(self.asked, self.traces, pair)
        return {
            "path": pair.path,
            "kind": pair.kind.value,
            "void": pair.void_reason,
            "baseline": self._arm(self.asked.baseline, pair, pair.baseline, tracks[0]),
            "repair": self._arm(self.asked.repair, pair, pair.repair, tracks[1]),
            "parting_step": parting_step(*tracks),
        }

    def _arm(self, variant: str, pair: Pair, trial: Outcome | None, track: Track) -> Any:
        if trial is None:
            return None
        address = TrialAddress(variant, pair.path, pair.seed, pair.scene)
        named = {each.name: each for each in self.signals.get(address, ())}
        plan = self.plans.get(pair.scene)
        crashed = trial.status is Status.CRASH and plan is not None and len(track)
        return {
            "status": trial.status.value,
            "ended": wording.ended(self.asked, trial.status),
            "time_s": trial.time_s,
            "distance_m": trial.metrics.get("terminal_distance_m"),
            "hit": hit(plan, track[-1]) if crashed and plan else None,
            "track": self._put(_centimetres(track).T) if len(track) else None,
            "attitude": self._frames(named),
            "wind": self._first(named, _WIND, 3, 100.0),
            "lines": drawn(named, self.plots, self.series),
            "struck": in_force(named),
        }

    def _frames(self, named: Mapping[str, Signal]) -> int | None:
        """Put down rotation matrices, body to world, row by row in thousandths."""
        return self._first(named, _ATTITUDE, 9, 1000.0)

    def _first(
        self, named: Mapping[str, Signal], names: Iterable[str], parts: int, scale: float
    ) -> int | None:
        for name in names:
            if name in named and named[name].values.shape[1] == parts:
                values = np.nan_to_num(named[name].values.astype(np.float64))
                return self._put(np.rint(scale * np.clip(values, -1e6, 1e6)).astype(np.int32).T)
        return None

    def _put(self, rows: NDArray[np.int32]) -> int:
        self.series.extend(rows)
        return len(self.series) - len(rows)


def _centimetres(track: Track) -> NDArray[np.int32]:
    held = np.clip(np.nan_to_num(track), -_FARTHEST_M, _FARTHEST_M)
    return np.rint(100.0 * held).astype(np.int32)


def _space(traces: Traces, plans: Mapping[str, FloorPlan]) -> str:
    if not any(map(len, traces.positions.values())):
        return "none"
    solid = any(plan.prisms or plan.pillars for plan in plans.values())
    flat = not solid and all(not track[:, 1:].any() for track in traces.positions.values())
    return "line" if flat else "space"


def _with_positions(signals: Signals, traces: Traces) -> Signals:
    def others(at: TrialAddress, axis: Track) -> Iterator[Signal]:
        for each in signals.get(at, ()):
            if not np.array_equal(each.values, axis[: len(each.values)]):
                yield each

    return {
        at: (Signal("position", "position", "m", track[:, :1]), *others(at, track[:, :1]))
        for at, track in traces.positions.items()
    }


def _kept(
    signals: Signals, chosen: Sequence[tuple[str, int]], groups: Iterable[tuple[str, int]]
) -> Signals:
    with_signals = {(at.scene, at.seed) for at in signals}
    order = [at for at in dict.fromkeys((*chosen, *groups)) if at in with_signals]
    few = set(order[:_MOST_WITH_SIGNALS])
    return {at: named for at, named in signals.items() if (at.scene, at.seed) in few}


def _plan(plan: FloorPlan) -> dict[str, Any]:
    drawn = asdict(plan)
    del drawn["title"]
    for prism in drawn["prisms"]:
        prism["corners"] = [[round(v, 3) for v in corner] for corner in prism["corners"]]
    return drawn
