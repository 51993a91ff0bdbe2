"""Every trial as the page's script needs it to draw it again, small enough to be in the page."""

import json
import zlib
from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faultpath.analyses.model import SHARED, AuditResult
from faultpath.analyses.pairs import Pair, alike, by_scene, choose, is_sample
from faultpath.analyses.parting import Recorded, parting
from faultpath.report.inputs import ReportInput
from faultpath.report.plots import Plot, first_plot, plots_of
from faultpath.report.sentences import wording
from faultpath.report.sentences.parting import DIFFERS, ending, parted
from faultpath.run.store.signals import DRAWN, IN_FORCE, Signal, Signals
from faultpath.run.store.tables import Trace, TrialAddress, traces_of
from faultpath.system.outcome import Outcome

_MOST_WITH_SIGNALS = 12
"""Scenes, with a seed each, whose signals go into a page."""
_FARTHEST_M = 1e6
"""Beyond this a position is no longer drawn where it was: in centimetres it must stay a number."""
_LEVELS = 4095
_GAP = -1
"""In place of a level, where nothing was read."""
_LIFTED = 10**9
"""In place of a coordinate of a picture, where the pen is lifted."""


@dataclass(frozen=True)
class Viewer:
    """Parts of the viewer that a page needs beside its script."""

    space: str
    """`space`: positions are drawn to scale, from above where there are floor plans; `picture`: as
    the system renders them; `line`: they lie on one axis and are plotted over time; `none`: the
    system gives neither."""
    shown: frozenset[tuple[str, int]]
    """Scenes and seeds that can be looked at."""
    whole: bool
    """Whether these are all that ran."""
    plans: bool
    """Whether scenes have a floor plan, with start and goal."""
    packed: str
    """All else, for the script."""


def viewer_data(source: ReportInput, pairs: Sequence[Pair]) -> Viewer | None:
    """Return every trial for the page's script; `None` where there is nothing to play.

    Left out are scenes without any track and, where no trial has one, those without signals.
    """
    plans, tracks = source.system.plans, traces_of(source.trials)
    flat, every = _flat(source, tracks), by_scene(pairs)
    recorded = {(at.scene, at.seed) for at in source.signals}
    tracked = {(at.scene, at.seed) for at, track in tracks.items() if len(track)}
    first = choose(source.record, pairs, recorded)
    chosen = [at for at in first if at in (tracked or recorded)]
    playable = [at for at in dict.fromkeys((*chosen, *every)) if at in (tracked or recorded)]
    few = [at for at in playable if at in recorded][:_MOST_WITH_SIGNALS]
    groups = {at: of for at, of in every.items() if at in (tracked or few)}
    if not groups:
        return None
    signals = {at: s for at, s in source.signals.items() if (at.scene, at.seed) in few}
    if tracked and flat:
        signals = _with_positions(signals, tracks)
    trials, space = _Trials(source, signals, plots_of(signals)), _space(source, flat, bool(tracked))
    scenes = _scenes(trials, groups, captions(pairs, is_sample(source.trials)))
    drawn = {scene: asdict(plans[scene]) for scene, _ in groups if scene in plans}
    for prism in (prism for plan in drawn.values() for prism in plan["prisms"]):
        prism["corners"] = [[round(v, 3) for v in corner] for corner in prism["corners"]]
    content = {
        "dt_s": source.system.control_dt_s,
        "space": space,
        "conditions": [
            {"name": condition.name, "title": condition.title}
            for condition in source.record.conditions
        ],
        "picked": [list(groups).index(at) for at in chosen],
        "condition": _first_condition(source.record, groups[(*chosen, *groups)[0]]),
        "plot": 0 if space == "space" else first_plot(source, signals, trials.plots),
        "plots": [plot.described() for plot in trials.plots],
        "plans": drawn,
        "scenes": scenes,
        "ran": len(every),
    }
    whole = len(groups) == len(every)
    return Viewer(space, frozenset(groups), whole, bool(drawn), pack(content, trials.series))


def captions(pairs: Sequence[Pair], sampled: bool = False) -> dict[tuple[str, int], str]:
    """Say of each scene and seed in how many the same versions succeed under every condition, and
    whether it is typical of them."""
    groups = alike(pairs)
    scenes, seeds = ({at[part] for at in groups} for part in (0, 1))
    total = f"{len(scenes)} {'sampled scenes' if sampled else 'scenes'}"
    if len(seeds) > 1:
        total = f"{len(groups)} ({total}, {len(seeds)} seeds)"
    typical = " It is a typical one: its trials end apart at the median time of these."
    return {
        at: f"{count} of {total} {'goes' if count == 1 else 'go'} like this one: the same versions "
        f"succeed under each condition.{typical if is_typical else ''}"
        for at, (count, is_typical) in groups.items()
    }


def _scenes(
    trials: "_Trials",
    groups: Mapping[tuple[str, int], Mapping[str, Pair]],
    why: Mapping[tuple[str, int], str],
) -> list[dict[str, Any]]:
    """Return each scene and seed with its pairs, as the script reads them."""
    question, plans = trials.source.record.question, trials.source.system.plans
    return [
        {
            "scene": scene,
            "seed": seed,
            "title": plans[scene].title if scene in plans else "",
            "why": why.get((scene, seed), ""),
            "pairs": [
                {
                    "condition": pair.condition,
                    "kind": pair.kind.value,
                    "void": pair.void_reason,
                    "parting": trials.parting(pair),
                    "baseline": trials.packed(question.baseline, pair, pair.baseline),
                    "repair": trials.packed(question.repair, pair, pair.repair),
                }
                for pair in group.values()
            ],
        }
        for (scene, seed), group in groups.items()
    ]


def _flat(source: ReportInput, tracks: Mapping[TrialAddress, Trace]) -> bool:
    """Return whether all positions lie on one axis, among no obstacles."""
    return not any(plan.prisms or plan.pillars for plan in source.system.plans.values()) and all(
        not track[:, 1:].any() for track in tracks.values()
    )


def _space(source: ReportInput, flat: bool, tracked: bool) -> str:
    named = source.signals.values()
    if flat and any(signal.name == DRAWN for signals in named for signal in signals):
        return "picture"
    return "none" if not tracked else "line" if flat else "space"


def _first_condition(result: AuditResult, pairs: Mapping[str, Pair]) -> str:
    """Return the condition marked first: one on which the first scene shows what is significant."""
    signs = {effect.condition: effect.sign for effect in result.effects if effect.leads}
    apart = [
        condition
        for condition, pair in pairs.items()
        if pair.sign and signs.get(condition) == pair.sign
    ]
    primary = result.facts.primary or SHARED
    return apart[0] if apart and primary not in apart else primary


@dataclass
class _Trials:
    """Trials as the script reads them, with their numbers in `series`."""

    source: ReportInput
    signals: Signals
    plots: Sequence[Plot]
    series: list[NDArray[np.int32]] = field(default_factory=list[NDArray[np.int32]])

    def packed(self, variant: str, pair: Pair, trial: Outcome | None) -> dict[str, Any] | None:
        """Return a trial, of which what is long stands in `series`; `None` where it never ran."""
        if trial is None:
            return None
        address = TrialAddress(variant, pair.condition, pair.seed, pair.scene)
        named = {signal.name: signal for signal in self.signals.get(address, ())}
        track = np.empty((0, 3), np.float32) if trial.trace is None else trial.trace
        faulted: list[list[int]] = []
        if IN_FORCE in named:
            on = named[IN_FORCE].values[:, 0] > 0
            edges = np.flatnonzero(np.diff(on, prepend=False, append=False))
            faulted = edges.reshape(-1, 2).tolist()
        return {
            "status": trial.status.value,
            "ended": wording.ended(self.source.record.facts, trial.status),
            "time_s": trial.time_s,
            "track": self._put(np.nan_to_num(track[:, :2])) if len(track) else None,
            "drawn": [self._put(named[DRAWN].values), named[DRAWN].values.shape[1]]
            if DRAWN in named
            else None,
            "lines": self._lines(named),
            "faulted": faulted,
        }

    def parting(self, pair: Pair) -> dict[str, Any] | None:
        """Return where the two trials part, in words and as steps; `None` where that was not
        recorded of both."""
        result, signals = self.source.record, self.source.signals
        names = result.question.baseline, result.question.repair
        addresses = [TrialAddress(n, pair.condition, pair.seed, pair.scene) for n in names]
        if not all(signals.get(at) for at in addresses):
            return None
        one, other = (
            Recorded(at, outcome, signals[at])
            for at, outcome in zip(addresses, (pair.baseline, pair.repair), strict=True)
        )
        differences = parting(self.source.system, one, other)
        marks = [(first.step, DIFFERS[kind]) for kind, first in differences.first.items()]
        marks += ending(differences, self.source.system.control_dt_s)
        return {"said": parted(result.facts, differences), "marks": marks}

    def _put(self, metres: NDArray[np.float32]) -> int:
        """Put coordinates into `series` as whole centimetres, and return where they begin."""
        centimetres = 100.0 * np.clip(metres.astype(np.float64), -_FARTHEST_M, _FARTHEST_M)
        whole = np.where(np.isfinite(centimetres), np.rint(centimetres), _LIFTED).astype(np.int32)
        self.series.extend(whole.T)
        return len(self.series) - whole.shape[1]

    def _lines(self, named: Mapping[str, Signal]) -> list[list[float | int]]:
        """Return `[plot, line, place in series, lowest value, value of a level]` of each line."""
        lines: list[list[float | int]] = []
        for number, plot in enumerate(self.plots):
            for place, ((name, part), _) in enumerate(plot.lines):
                if name not in named:
                    continue
                values = named[name].values[:, part].astype(np.float64)
                finite = values[np.isfinite(values)]
                if not finite.size:
                    continue
                low = float(finite.min())
                level = float(finite.max() - low) / _LEVELS or 1.0
                whole = np.where(np.isfinite(values), np.rint((values - low) / level), _GAP)
                ends = float(f"{low:.7g}"), float(f"{level:.7g}")
                lines.append([number, place, len(self.series), *ends])
                self.series.append(whole.astype(np.int32))
        return lines


def pack(content: Mapping[str, Any], series: Sequence[NDArray[np.int32]]) -> str:
    """Return `content`, which is JSON, and series of whole numbers, deflated, as base64.

    Series are kept as second differences, which are near zero along a track.
    """
    steps = [np.diff(values.astype(np.int64), 2, prepend=(0, 0)).tolist() for values in series]
    whole = {**content, "series": steps}
    text = json.dumps(whole, separators=(",", ":"), allow_nan=False)
    return b64encode(zlib.compress(text.encode(), 9)).decode()


def _with_positions(signals: Signals, positions: Mapping[TrialAddress, Trace]) -> Signals:
    """Return the signals with the position before them, and nothing that only repeats it."""
    by_trial: dict[TrialAddress, tuple[Signal, ...]] = {}
    for at, track in positions.items():
        axis = track[:, :1]
        others = (
            signal
            for signal in signals.get(at, ())
            if not np.array_equal(signal.values, axis[: len(signal.values)])
        )
        by_trial[at] = (Signal("position", "position", "m", axis), *others)
    return by_trial
