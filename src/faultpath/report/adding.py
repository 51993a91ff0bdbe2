"""How the errors of two modules add up in one scene, in words and as a picture."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from faultpath.record import CORRECT, wording
from faultpath.record.wording import where
from faultpath.report.inputs import ReportInput
from faultpath.report.pairing import Pair, by_scene
from faultpath.report.svg import (
    Axis,
    Point,
    Svg,
    covering,
    draw_levels,
    draw_tick,
    shortened,
    tick_label,
)
from faultpath.report.viewer_choice import choose
from faultpath.store import TrialAddress
from faultpath.store.signals import TOGETHER, Signal
from faultpath.trials import Status

_SQUEEZED = 2.5
_MOST_PATHS = 4
"""The last ones, among them the shared fault."""


@dataclass(frozen=True)
class Lines:
    """Two errors of one trial and their sum."""

    role: str
    name: str
    values: NDArray[np.float64]
    """`[3, T]`: the errors and their sum, a number a control step, not a number where unknown."""
    status: Status
    ended: str
    time_s: float

    @property
    def sizes(self) -> tuple[float, ...]:
        """Mean size of each, while the trial ran."""
        return tuple(float(each) for each in np.nanmean(np.abs(self.values), axis=1))


@dataclass(frozen=True)
class Adding:
    """One scene: on every path of the fault the errors of both arms."""

    scene: str
    words: str
    """What they are errors of."""
    unit: str
    names: tuple[str, ...]
    """Of the two errors and of their sum."""
    dt_s: float
    paths: tuple[tuple[str, str, tuple[Lines, ...]], ...]
    """Name and title of a path, with the baseline's lines and the repair's."""

    @property
    def span(self) -> tuple[float, float]:
        """The range of the values; where a few would squeeze the others, that of the others."""
        values = self._every
        low, high = (float(end) for end in np.quantile(values, (0.03, 0.97)))
        few = values.max() - values.min() > _SQUEEZED * max(high - low, 1e-9)
        return (low, high) if few else (float(values.min()), float(values.max()))

    @property
    def cut(self) -> bool:
        """Whether some values lie outside that range."""
        low, high = self.span
        return bool(self._every.min() < low or self._every.max() > high)

    @property
    def _every(self) -> NDArray[np.float64]:
        arms = (arm.values for _, _, both in self.paths for arm in both)
        return np.concatenate([values[np.isfinite(values)] for values in arms])

    @property
    def caption(self) -> str:
        """Say what is to be seen on the last path, in numbers of this scene alone."""
        path, _, arms = self.paths[-1]
        digits = 2 if min(max(arm.sizes) for arm in arms) < 1 else 1
        told = "; ".join(self._said(arm, digits) for arm in arms)
        return f"In scene {self.scene}, {where(path)}, {told}."

    def _said(self, arm: Lines, digits: int) -> str:
        one, other, both = (f"{wording.plain(size, digits)} {self.unit}" for size in arm.sizes)
        return (
            f"the errors of {arm.name} are {one.removesuffix(f' {self.unit}')} and {other} on "
            f"average and their sum {both} ({arm.ended} after {arm.time_s:.1f} s)"
        )


def adding(source: ReportInput, pairs: Sequence[Pair]) -> Adding | None:
    """Return the first scene of the viewer of which both errors are known on a path of the fault.

    `None` where the system names no errors, or nothing was recorded.
    """
    groups = by_scene(pairs)
    for at in choose(source.record, source.traces, pairs) if source.signals else ():
        found = _of(source, groups[at])
        if found is not None:
            return found
    return None


def _of(source: ReportInput, pairs: Mapping[str, Pair]) -> Adding | None:
    asked = source.record.question
    arms = (("baseline", asked.baseline), ("repair", asked.repair))
    paths: list[tuple[str, str, tuple[Lines, ...]]] = []
    terms: list[Signal] = []
    for path in source.record.paths:
        if path.name == CORRECT or path.name not in pairs:
            continue
        lines: list[Lines] = []
        for role, name in arms:
            pair = pairs[path.name]
            trial = pair.baseline if role == "baseline" else pair.repair
            at = TrialAddress(name, path.name, pair.seed, pair.scene)
            found = _terms(source.signals.get(at, ()))
            if trial is not None and found:
                terms = [*found]
                values = np.array([each.values[:, 0] for each in found], np.float64)
                ended = wording.ended(asked, trial.status)
                lines.append(Lines(role, name, values, trial.status, ended, trial.time_s))
        if len(lines) == len(arms):
            paths.append((path.name, path.title, tuple(lines)))
    if not paths:
        return None
    names = tuple(each.name for each in terms)
    return Adding(
        next(iter(pairs.values())).scene,
        terms[0].topic,
        wording.unit(terms[0].unit),
        names,
        source.traces.dt_s,
        tuple(paths[-_MOST_PATHS:]),
    )


def _terms(named: Sequence[Signal]) -> tuple[Signal, ...]:
    topics = [each.topic for each in named if each.name == TOGETHER]
    found = [each for each in named if each.topic in topics]
    known = all(np.isfinite(each.values).any() for each in found)
    return (*found,) if len(found) == 3 and found[-1].name == TOGETHER and known else ()


_WIDTH, _LEFT, _RIGHT = 308.0, 38.0, 14.0
_TOP, _PLOT, _PITCH = 44.0, 96.0, 136.0
_LINES = ("term one", "term two", "term both")
_SIGN = {Status.SUCCESS: "M-5 0l3 4l7 -9", Status.CRASH: "M-5 -5l10 10M5 -5l-10 10"}
_OTHER = "M-4 -4h8v8h-8Z"


def adding_panels(shown: Adding) -> list[str]:
    """Return a picture of each path, the baseline above the repair, all on the same axes."""
    arms = [arm for _, _, both in shown.paths for arm in both]
    upward = covering(shown.span, least=1e-9)
    clock = Axis(0.0, max(arm.time_s for arm in arms), _LEFT, _WIDTH - _RIGHT)
    return [_panel(shown, title, both, upward, clock) for _, title, both in shown.paths]


def line_key(shown: Adding) -> list[tuple[str, str]]:
    """Return a sample of each line with what it stands for."""
    found: list[tuple[str, str]] = []
    for name, cls in zip(shown.names, _LINES, strict=True):
        svg = Svg(34, 12, name)
        svg.line((1, 6), (33, 6), cls)
        found.append((svg.render(), name))
    return found


def _panel(shown: Adding, title: str, arms: tuple[Lines, ...], upward: Axis, clock: Axis) -> str:
    told = " ".join(
        f"{arm.role.capitalize()} {arm.name}: mean size "
        + ", ".join(f"{name} {size:.2g}" for name, size in zip(shown.names, arm.sizes, strict=True))
        + f" {shown.unit}; {arm.ended} after {arm.time_s:.1f} s."
        for arm in arms
    )
    name = f"{title}: {shown.words} over time, scene {shown.scene}"
    svg = Svg(_WIDTH, _TOP + _PITCH * len(arms) - 16, name, told)
    svg.text(0, 14, shortened(title, _WIDTH, 13), "head", tip=title)
    for place, arm in enumerate(arms):
        top = _TOP + _PITCH * place
        y = upward.at(top + _PLOT, top)
        _arm(svg, arm, clock, y, shown)
    bottom = _TOP + _PITCH * (len(arms) - 1) + _PLOT
    for tick in clock.ticks(4):
        draw_tick(svg, clock, Axis(0, 1, bottom, 0), tick, tick_label(tick))
    svg.text(_WIDTH, bottom + 17, "s", "small soft", "end")
    return svg.render()


def _arm(svg: Svg, arm: Lines, x: Axis, y: Axis, shown: Adding) -> None:
    svg.text(0, y.end - 10, arm.role, "small soft")
    room = 130.0
    svg.text(54, y.end - 10, shortened(arm.name, room, 12), f"bold {arm.role}", tip=arm.name)
    ended = f"{arm.ended}, {arm.time_s:.1f} s"
    svg.text(_WIDTH, y.end - 10, ended, "small soft", "end")
    draw_levels(svg, x, y, 4, zero="zero")
    svg.text(_LEFT - 6, y.start + 14, shown.unit, "small soft", "end")
    inside: list[list[float]] = np.clip(arm.values, y.low, y.high).tolist()

    def points(values: list[float]) -> list[Point]:
        steps = enumerate(values)
        return [(x(step * shown.dt_s), y(value)) for step, value in steps if isfinite(value)]

    both = points(inside[-1])
    if both:
        svg.polygon([(both[0][0], y(0)), *both, (both[-1][0], y(0))], f"left-over {arm.role}")
    for values, cls in zip(inside, _LINES, strict=True):
        svg.polyline(points(values), f"{cls} {arm.role}" if cls == _LINES[-1] else cls)
    end = x(arm.time_s)
    svg.line((end, y.start), (end, y.end), "ended")
    with svg.group(transform=f"translate({end:.1f} {y.end + 8:.1f})"):
        svg.path(_SIGN.get(arm.status, _OTHER), f"end-sign {arm.role}")
