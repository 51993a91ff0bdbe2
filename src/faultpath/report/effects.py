"""Effects with their intervals, path by path, and over the frequency of the fault."""

from collections.abc import Sequence
from dataclasses import dataclass

from faultpath.decisions import wording
from faultpath.decisions.model import DecisionRecord, Effect, PathBreakEven
from faultpath.report.svg import (
    Axis,
    Point,
    Svg,
    covering,
    draw_interval,
    draw_levels,
    draw_tick,
    draw_uprights,
    shortened,
    text_width,
    wrapped,
)
from faultpath.statistics import Estimate

_PITCH, _TOP = 48.0, 44.0
_ROOM = 26.0  # pixels beside zero that a label of a side needs


@dataclass(frozen=True)
class EffectRow:
    """One effect in a picture."""

    label: str
    effect: Estimate
    sign: int
    """Side that is decided for: 1 the repair, -1 the baseline, 0 neither."""
    note: str
    """Whether it is the primary contrast, and what keeps it out of a headline."""
    band_pp: float | None
    """Difference that is detected with 80 % power, where none is decided."""


Rows = Sequence[tuple[str, EffectRow | str]]
"""A label with its effect, or with why there is none."""


def effect_row(label: str, effect: Effect, note: str = "") -> EffectRow:
    """Return how an effect is drawn."""
    return EffectRow(
        label=label,
        effect=effect.success,
        sign=effect.sign,
        note=", ".join(filter(None, (note, wording.reservation(effect)))),
        band_pp=None if effect.detected else effect.minimum_detectable_pp,
    )


def forest(record: DecisionRecord) -> str:
    """Return the success differences of an audit, percentage points, one row a path."""
    titles, asked = {path.name: path.title for path in record.paths}, record.question
    rows = [
        effect_row(
            titles.get(effect.path, effect.path),
            effect,
            "primary" if effect.path == asked.primary else "",
        )
        for effect in record.effects
    ]
    labelled = [(row.label, row) for row in rows]
    return panel(f"{asked.repair} minus {asked.baseline}", labelled, shared_axis([labelled]), 480)


def shared_axis(panels: Sequence[Rows]) -> Axis:
    """Return the axis that all panels have in common, percentage points."""
    ends: list[float] = []
    for row in (row for rows in panels for _, row in rows if isinstance(row, EffectRow)):
        e = row.effect
        ends += [v for v in (e.value, e.low, e.high, *(e.per_seed or ())) if v is not None]
        ends += [-row.band_pp, row.band_pp] if row.band_pp else []
    return covering(ends, least=10.0)


def panel(title: str, rows: Rows, axis: Axis, width: float = 350.0) -> str:
    """Return success of the repair minus success of the baseline, one row a label.

    A filled dot is a decided effect; the light band behind an open one reaches as far as the
    difference that is detected with 80 % power.
    """
    values = [row if isinstance(row, str) else wording.with_interval(row.effect) for _, row in rows]
    told = "; ".join(f"{label}: {value}" for (label, _), value in zip(rows, values, strict=True))
    bottom = _TOP + _PITCH * len(rows)
    name = f"{title}: success of the repair minus success of the baseline, percentage points"
    svg = Svg(width, bottom + 40, name, told)
    svg.text(0, 14, shortened(title, width, 13), "head", tip=title)
    plot = axis.at(8, width - 8)
    directions(svg, plot, 33)
    draw_uprights(svg, plot, _TOP - 4, bottom, 6)
    svg.text(width / 2, bottom + 34, "repair minus baseline, pp", "small soft", "middle")
    for index, ((label, row), value) in enumerate(zip(rows, values, strict=True)):
        y = _TOP + _PITCH * index
        note, sign = ("", 0) if isinstance(row, str) else (row.note, row.sign)
        room = width - text_width(value, 12) - text_width(note, 11) - 18
        short = shortened(label, room, 12)
        beside = text_width(short, 12) + (text_width(note, 11) + 12 if note else 6)
        svg.rect(0, y + 3, beside, 18, "paper")
        svg.rect(width - text_width(value, 12) - 6, y + 3, text_width(value, 12) + 6, 18, "paper")
        svg.text(0, y + 16, short, tip=label)
        if note:
            svg.text(text_width(short, 12) + 6, y + 16, note, "small soft")
        svg.text(width, y + 16, value, "bold" if sign else "", "end")
        if isinstance(row, EffectRow):
            mark(svg, plot, row.effect, y + 34, row.sign, row.band_pp)
    return svg.render()


def directions(svg: Svg, plot: Axis, y: float) -> None:
    """Say on which side of zero which arm is better."""
    zero = plot(0.0)
    if zero - plot.start > 96:
        svg.text(zero - 8, y, "← baseline better", "small baseline", "end")
    if plot.end - zero > 88:
        svg.text(zero + 8, y, "repair better →", "small repair", "start")


def mark(svg: Svg, plot: Axis, e: Estimate, y: float, winner: int, band_pp: float | None) -> None:
    """Draw one interval in the colour of the arm that it speaks for.

    Dot, whiskers, a tick for each seed, and the undetectable band where one is given. `winner` is
    1 for the repair, -1 for the baseline, 0 where it is open.
    """
    side = {1: " repair", -1: " baseline", 0: ""}[winner]
    if band_pp:
        svg.rect(plot(-band_pp), y - 11, plot(band_pp) - plot(-band_pp), 22, "band", 2)
        for edge in (-band_pp, band_pp):
            svg.line((plot(edge), y - 11), (plot(edge), y + 11), "band-edge")
        svg.line((plot(0), y - 11), (plot(0), y + 11), "zero")
    if e.low is not None and e.high is not None:
        draw_interval(svg, plot, (e.low, e.high), y, 4, "range" + side)
    if e.per_seed is not None and len(e.per_seed) > 1:
        for value in e.per_seed:
            svg.line((plot(value), y + 6), (plot(value), y + 11), "seed")
    svg.circle((plot(e.value), y), 4.5, "dot" + side if side else "dot open")


def frequency_panels(record: DecisionRecord) -> list[str]:
    """Return the expected success difference over the frequency of the fault, a picture a path.

    The band is the interval at each frequency, at the level that the family leaves. The thick line
    on zero is the set of frequencies at which neither arm is decided to be ahead, the ring the
    estimate of the crossing. The curve has the colour of an arm where that arm is decided to be
    ahead.
    """
    titles = {path.name: path.title for path in record.paths}
    drawn = [path for path in record.break_even if path.curve]
    axis = covering((v for path in drawn for _, *ends in path.curve for v in ends), least=10.0)
    return [_frequency(path, titles.get(path.path, path.path), axis) for path in drawn]


def _frequency(path: PathBreakEven, title: str, vertical: Axis) -> str:
    shown = wording.break_even(path.result)
    words = f"{path.words or 'No frequency is decided'}."
    svg = Svg(290, 278, f"{title}: expected success difference against fault frequency", words)
    svg.text(0, 14, shortened(title, 285, 13), "head", tip=title)
    for i, line in enumerate(wrapped(words, 285, 11, 2)):
        svg.text(0, 31 + 14 * i, line, "small soft", tip=words)
    x, y = Axis(0.0, 1.0, 34, 280), vertical.at(238, 72)
    draw_levels(svg, x, y, 5, zero="zero")
    for percent in (0, 25, 50, 75, 100):
        draw_tick(svg, x, y, percent / 100, str(percent))
    svg.text(x(0.5), y.start + 34, "share of episodes with the fault, %", "small soft", "middle")
    svg.text(0, y.end - 10, "expected difference in success, pp", "small soft")
    upper = [(x(p), y(high)) for p, _, _, high in path.curve]
    lower = [(x(p), y(low)) for p, _, low, _ in path.curve]
    svg.polygon([*upper, *reversed(lower)], "fan")
    first, last = path.curve[0][1], path.curve[-1][1]

    def point(p: float) -> Point:
        return x(p), y((1 - p) * first + p * last)

    # In an arm's colour only where a sentence names the arm.
    for low, high in path.result.pieces if path.words else ((0.0, 1.0),):
        svg.polyline([point(low), point(high)], "curve")
    for region in path.result.regions if path.words else ():
        side = "repair" if region.sign > 0 else "baseline"
        svg.polyline([point(region.low), point(region.high)], f"curve {side}")
    for low, high in path.result.pieces:
        svg.line((x(low), y(0)), (x(high), y(0)), "star-range")
    if path.result.p_star is not None and path.result.regions:
        tip = "no frequency is decided" if shown == "any" else f"not decided at {shown}"
        svg.circle((x(path.result.p_star), y(0)), 5, "star", tip=tip)
    if y(0) - y.end > _ROOM:
        svg.text(x.start + 6, y.end + 12, "repair better", "small repair halo")
    if y.start - y(0) > _ROOM:
        svg.text(x.start + 6, y.start - 6, "baseline better", "small baseline halo")
    return svg.render()
