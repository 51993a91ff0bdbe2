"""How the errors of two modules add up in one scene, in words and as a picture."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from faultpath.analyses.model import CORRECT, where
from faultpath.analyses.pairs import Pair, by_scene, choose
from faultpath.report.inputs import ReportInput
from faultpath.report.sentences import wording
from faultpath.report.svg import (
    BOLD,
    Axis,
    Point,
    Svg,
    covering,
    draw_axes,
    text_width,
    tick_label,
)
from faultpath.run.store.signals import TOGETHER, Signal
from faultpath.run.store.tables import TrialAddress
from faultpath.system.outcome import Outcome, Status

_SQUEEZED = 2.5
_MOST_CONDITIONS = 4
"""The last ones, among them the shared fault."""
_WIDTH, _LEFT, _RIGHT = 308.0, 38.0, 14.0
_TOP, _PLOT, _PITCH = 44.0, 96.0, 136.0
_SIGN = {Status.SUCCESS: "M-5 0l3 4l7 -9", Status.CRASH: "M-5 -5l10 10M5 -5l-10 10"}
_OTHER = "M-4 -4h8v8h-8Z"
_NAME = 110.0
"""Width of the longest name of a version."""


@dataclass(frozen=True)
class Lines:
    """Two errors of one trial and their sum."""

    role: str
    name: str
    terms: Sequence[Signal]
    values: NDArray[np.float64]
    """`[3, T]`: the errors and their sum, a number a control step, not a number where unknown."""
    trial: Outcome
    ended: str

    @property
    def sizes(self) -> tuple[float, ...]:
        """Mean size of each, while the trial ran."""
        return tuple(float(size) for size in np.nanmean(np.abs(self.values), axis=1))


@dataclass(frozen=True)
class Adding:
    """One scene: under every condition of the fault the errors of both variants."""

    words: str
    """Quantity that the errors are of."""
    unit: str
    names: tuple[str, ...]
    """Names of the two errors and of their sum."""
    conditions: tuple[tuple[str, tuple[Lines, ...]], ...]
    """Title of a condition, with the baseline's lines and the repair's."""
    caption: str
    """Summary of the last condition, in numbers of this scene alone."""
    span: tuple[float, float]
    """The range of the values; where a few would squeeze the others, that of the others."""
    beyond: str
    """The largest value outside that range, with its unit; empty where none lies outside."""
    dt_s: float

    @property
    def longest_s(self) -> float:
        """Time that the longest trial took."""
        times = (variant.trial.time_s for _, variants in self.conditions for variant in variants)
        return max(*times, self.dt_s)


def adding(source: ReportInput, pairs: Sequence[Pair]) -> Adding | None:
    """Return the first scene of the viewer with both errors known under a condition of the fault;
    `None` where the system names no errors, or nothing was recorded."""
    groups, recorded = by_scene(pairs), {(at.scene, at.seed) for at in source.signals}
    for at in choose(source.record, pairs, recorded) if recorded else ():
        example = _of(source, at[0], groups[at])
        if example is not None:
            return example
    return None


def _lines(source: ReportInput, pair: Pair) -> Iterator[Lines]:
    """Yield the lines of the baseline and of the repair, where both errors are known."""
    facts, question = source.record.facts, source.record.question
    for role, name, trial in (
        ("baseline", question.baseline, pair.baseline),
        ("repair", question.repair, pair.repair),
    ):
        named = source.signals.get(TrialAddress(name, pair.condition, pair.seed, pair.scene), ())
        topics = [signal.topic for signal in named if signal.name == TOGETHER]
        terms = [signal for signal in named if signal.topic in topics]
        numbers = all(np.isfinite(signal.values).any() for signal in terms)
        if trial and numbers and len(terms) == 3 and terms[-1].name == TOGETHER:
            values = np.array([signal.values[:, 0] for signal in terms], np.float64)
            ended = f"{wording.ended(facts, trial.status)}, {trial.time_s:.1f} s"
            yield Lines(role, name, terms, values, trial, ended)


def _of(source: ReportInput, scene: str, pairs: Mapping[str, Pair]) -> Adding | None:
    titles, conditions = source.record.titles, dict[str, tuple[Lines, ...]]()
    for name in titles:
        lines = tuple(_lines(source, pairs[name])) if name != CORRECT and name in pairs else ()
        if len(lines) == 2:
            conditions[name] = lines
    if not conditions:
        return None
    values = np.concatenate([v.values.ravel() for pair in conditions.values() for v in pair])
    values = values[np.isfinite(values)]
    low, high = (float(end) for end in np.quantile(values, (0.03, 0.97)))
    whole = float(values.min()), float(values.max())
    cut = whole[1] - whole[0] > _SQUEEZED * max(high - low, 1e-9)
    last, variants = list(conditions.items())[-1]
    terms = variants[-1].terms
    unit, largest = wording.unit(terms[0].unit), max(whole, key=abs)
    digits = 2 if min(max(variant.sizes) for variant in variants) < 1 else 1
    descriptions: list[str] = []
    for variant in variants:
        one, other, both = (wording.plain(size, digits) for size in variant.sizes)
        descriptions.append(
            f"{variant.name}: {one} and {other} {unit}, together {both} {unit} ({variant.ended})"
        )
    return Adding(
        words=terms[0].topic,
        unit=unit,
        names=tuple(term.name for term in terms),
        conditions=tuple(
            (titles[name], lines) for name, lines in list(conditions.items())[-_MOST_CONDITIONS:]
        ),
        caption=f"Scene {scene}, {where(last)}, mean sizes: {'; '.join(descriptions)}.",
        span=(low, high) if cut else whole,
        beyond=f"{tick_label(float(f'{largest:.2g}'))} {unit}" if cut else "",
        dt_s=source.system.control_dt_s,
    )


def adding_panels(shown: Adding) -> list[Markup]:
    """Return a picture of each condition, the baseline above the repair, all on the same axes."""
    upward = covering(shown.span, least=1e-9)
    x = Axis(0.0, shown.longest_s, _LEFT, _WIDTH - _RIGHT)
    panels: list[Markup] = []
    for title, variants in shown.conditions:
        endings = "; ".join(
            f"{variant.role} {variant.name}: {variant.ended}" for variant in variants
        )
        svg = Svg(
            _WIDTH, _TOP + _PITCH * len(variants) - 16, f"{title}: {shown.words} over time", endings
        )
        svg.text(0, 14, title, "head", room=_WIDTH)
        for place, variant in enumerate(variants):
            top = _TOP + _PITCH * place
            y = upward.at(top + _PLOT, top)
            svg.text(0, top - 10, variant.role, "small soft")
            svg.text(54, top - 10, variant.name, f"bold {variant.role}", room=_NAME)
            left = 54 + min(_NAME, text_width(variant.name, 12 * BOLD)) + 8
            svg.text(_WIDTH, top - 10, variant.ended, "small soft", "end", room=_WIDTH - left)
            draw_axes(svg, x, y, 4, x.ticks(4) if variant is variants[-1] else ())
            svg.text(_LEFT - 6, y.start + 14, shown.unit, "small soft", "end")
            with svg.group(
                clip_path=svg.clip(variant.role, (x.start, y.end), (x.end, y.start), "until")
            ):
                _terms(svg, variant, x, y, shown.dt_s)
            _end(svg, variant, x(variant.trial.time_s), y)
        svg.text(_WIDTH, svg.height - 7, "s", "small soft", "end")
        panels.append(svg.render())
    return panels


def _terms(svg: Svg, variant: Lines, x: Axis, y: Axis, dt_s: float) -> None:
    """Draw both errors and their sum, and what the sum leaves."""
    steps = dt_s * np.arange(variant.values.shape[1], dtype=np.float64)
    lines: list[list[Point]] = []
    far = 100 * (y.high - y.low)  # what lies outside the axes is drawn outside, and cut there
    for values in np.clip(variant.values, y.low - far, y.high + far):
        known = np.isfinite(values)
        lines.append([(x(t), y(v)) for t, v in zip(steps[known], values[known], strict=True)])
    if both := lines[-1]:
        svg.polygon([(both[0][0], y(0)), *both, (both[-1][0], y(0))], f"left-over {variant.role}")
    for points, cls in zip(lines, ("one", "two", f"both {variant.role}"), strict=True):
        svg.polyline(points, f"term {cls}")


def _end(svg: Svg, variant: Lines, end: float, y: Axis) -> None:
    """Draw when and how the trial ended."""
    svg.line((end, y.start), (end, y.end), "ended")
    with svg.group(transform=f"translate({end:.1f} {y.end + 8:.1f})"):
        svg.path(_SIGN.get(variant.trial.status, _OTHER), f"end-sign {variant.role}")
