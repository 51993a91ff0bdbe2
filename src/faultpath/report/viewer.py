"""Every trial as the page's script needs it to draw it again, small enough to be in the page."""

import json
import zlib
from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faultpath.decisions import SHARED, DecisionRecord, Path, wording
from faultpath.report.inputs import Traces
from faultpath.report.pairing import Pair, by_scene
from faultpath.report.viewer_choice import captions, choose
from faultpath.report.viewer_signals import drawn, in_force, plots
from faultpath.trials import FloorPlan
from faultpath.trials.store import TrialAddress
from faultpath.trials.store.signals import Signal, Signals

_MOST_WITH_SIGNALS = 12
"""Scenes, with a seed each, whose signals go into a page."""
_FARTHEST_M = 1e6
"""Beyond this a position is no longer drawn where it was: in centimetres it must stay a number."""


@dataclass(frozen=True)
class Viewer:
    """What a page needs of the viewer beside its script."""

    paths: tuple[Path, ...]
    space: str
    """`space`: trials are drawn from above; `line`: their positions lie on one axis and are plotted
    over time; `none`: the system gives no positions."""
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
    """Return every trial for the page's script; `None` where there is nothing to play.

    Left out are scenes without any track and, where no trial has one, those without signals.
    """
    asked, space, kept = record.question, _space(traces, plans), signals or {}
    tracked = {(at.scene, at.seed) for at, track in traces.positions.items() if len(track)}
    playable = tracked if space != "none" else {(at.scene, at.seed) for at in kept}
    groups = {at: group for at, group in by_scene(pairs).items() if at in playable}
    if not groups:
        return None
    chosen = [at for at in choose(record, traces, pairs) if at in groups]
    kept = _of_few(kept, dict.fromkeys((*chosen, *groups)))
    if space == "line":
        kept = _with_positions(kept, traces)
    lines, series, why = plots(kept), list[NDArray[np.int32]](), captions(record, pairs)

    def arm(variant: str, pair: Pair, role: str) -> dict[str, Any] | None:
        trial = pair.baseline if role == "baseline" else pair.repair
        if trial is None:
            return None
        address = TrialAddress(variant, pair.path, pair.seed, pair.scene)
        named = {each.name: each for each in kept.get(address, ())}
        track = traces.positions.get(address, np.empty((0, 3), np.float32))
        place = len(series)
        held = np.clip(np.nan_to_num(track[:, :2]), -_FARTHEST_M, _FARTHEST_M)
        series.extend(np.rint(100.0 * held).astype(np.int32).T if len(track) else ())
        return {
            "status": trial.status.value,
            "ended": wording.ended(asked, trial.status),
            "time_s": trial.time_s,
            "track": place if len(track) else None,
            "lines": drawn(named, lines, series),
            "struck": in_force(named),
        }

    content = {
        "dt_s": traces.dt_s,
        "space": space,
        "paths": [{"name": path.name, "title": path.title} for path in record.paths],
        "picked": [list(groups).index(at) for at in chosen],
        "path": _begin(record, groups[chosen[0] if chosen else next(iter(groups))]),
        "plots": [plot.shown for plot in lines],
        "plans": {name: _plan(plans[name]) for name, _ in groups if name in plans},
        "scenes": [
            {
                "scene": scene,
                "seed": seed,
                "title": plans[scene].title if scene in plans else "",
                "why": why.get((scene, seed), ""),
                "pairs": [
                    {
                        "path": pair.path,
                        "void": pair.void_reason,
                        "baseline": arm(asked.baseline, pair, "baseline"),
                        "repair": arm(asked.repair, pair, "repair"),
                    }
                    for pair in group.values()
                ],
            }
            for (scene, seed), group in groups.items()
        ],
    }
    return Viewer(record.paths, space, frozenset(groups), pack(content, series))


def pack(content: Mapping[str, Any], series: Sequence[NDArray[np.int32]]) -> str:
    """Return `content`, which is JSON, and series of whole numbers, deflated, as base64.

    Series are kept as second differences, which are near zero along a track.
    """
    steps = [np.diff(each.astype(np.int64), 2, prepend=(0, 0)).tolist() for each in series]
    whole = {**content, "series": steps}
    text = json.dumps(whole, separators=(",", ":"), allow_nan=False)
    return b64encode(zlib.compress(text.encode(), 9)).decode()


def _begin(record: DecisionRecord, first: Mapping[str, Pair]) -> str:
    """Return the path that is marked first: one on which its scene shows what was decided."""
    signs = {effect.path: effect.sign for effect in record.effects if effect.leads}
    apart = [path for path, pair in first.items() if pair.sign and signs.get(path) == pair.sign]
    primary = record.question.primary or SHARED
    return apart[0] if apart and primary not in apart else primary


def _space(traces: Traces, plans: Mapping[str, FloorPlan]) -> str:
    if not any(map(len, traces.positions.values())):
        return "none"
    solid = any(plan.prisms or plan.pillars for plan in plans.values())
    flat = not solid and all(not track[:, 1:].any() for track in traces.positions.values())
    return "line" if flat else "space"


def _with_positions(signals: Signals, traces: Traces) -> Signals:
    """Return the signals with the position before them, and nothing that only repeats it."""
    found: dict[TrialAddress, tuple[Signal, ...]] = {}
    for at, track in traces.positions.items():
        axis = track[:, :1]
        others = (
            each
            for each in signals.get(at, ())
            if not np.array_equal(each.values, axis[: len(each.values)])
        )
        found[at] = (Signal("position", "position", "m", axis), *others)
    return found


def _of_few(signals: Signals, order: Iterable[tuple[str, int]]) -> Signals:
    """Return the signals of the first scenes that have some."""
    there = {(at.scene, at.seed) for at in signals}
    few = set([at for at in order if at in there][:_MOST_WITH_SIGNALS])
    return {at: named for at, named in signals.items() if (at.scene, at.seed) in few}


def _plan(plan: FloorPlan) -> dict[str, Any]:
    shown = asdict(plan)
    del shown["title"]
    for prism in shown["prisms"]:
        prism["corners"] = [[round(v, 3) for v in corner] for corner in prism["corners"]]
    return shown
