"""Effects with their intervals, condition by condition, and over the frequency of the fault."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from faultpath.analyses.effects import Effect
from faultpath.analyses.model import AuditResult, ConditionBreakEven
from faultpath.report.sentences import wording
from faultpath.report.sentences.phrases import ahead, in_short
from faultpath.report.svg import (
    Axis,
    Svg,
    covering,
    draw_axes,
    draw_band,
    shortened,
    text_width,
    tick_label,
)

_PITCH, _TOP, _NUMBERS = 48.0, 44.0, 146.0
"""Height of a panel's row, where the first begins, and width of the column of numbers."""
_WIDE, _HIGH = 330.0, 42.0
"""Size of the picture of one effect, which stands in a table."""
_ROOM = 26.0
"""Pixels beside zero that a label of a side needs."""

_SIDES = {1: "repair", -1: "baseline"}

Row = tuple[str, Effect | str]
"""A label, and the effect or why there is none."""


@dataclass(frozen=True)
class EffectRow:
    """An effect as the page lists it, its numbers beside its picture."""

    title: str
    notes: str
    rates: str
    """Success of the baseline and of the repair, %."""
    difference: str
    side: str
    """The variant that is significantly ahead, or `open`."""
    words: str
    picture: Markup
    boxed: bool
    """Whether a grey box shows which differences could be missed."""


def effect_rows(result: AuditResult) -> tuple[list[EffectRow], Markup]:
    """Return a row for every condition, all pictures on one axis, and the axis below them, with
    whose side is which."""
    plot = shared_axis(result.effects).at(6, _WIDE - 6)
    rows: list[EffectRow] = []
    for condition in result.conditions:
        effect = result.effect(condition.name)
        primary = "primary" if condition.name == result.facts.primary else ""
        svg = Svg(_WIDE, _HIGH, f"{condition.title}: repair minus baseline, pp")
        _grid(svg, plot, 0, _HIGH)
        if effect:
            _mark(svg, plot, effect, _HIGH / 2)
        rows.append(
            EffectRow(
                title=condition.title,
                notes=", ".join(filter(None, (primary, effect and wording.reservation(effect)))),
                rates=" → ".join(map(wording.plain, effect.rates)) if effect else "",
                difference=wording.with_interval(effect) if effect else "",
                side=_SIDES.get(effect.sign, "open") if effect else "open",
                words=in_short(result, effect),
                picture=svg.render(),
                boxed=effect is not None and bool(_band(effect)),
            )
        )
    axis = Svg(_WIDE, 38, "Success of the repair minus success of the baseline, percentage points")
    _tick_labels(axis, plot, 12)
    _sides(axis, plot, 32)
    return rows, axis.render()


def shared_axis(effects: Iterable[Effect]) -> Axis:
    """Return the axis that the pictures of effects have in common, percentage points."""
    ends: list[float] = []
    for e in effects:
        band = _band(e)
        ends += [v for v in (e.value, e.low, e.high, *e.per_seed) if v is not None]
        ends += [-band, band] if band else []
    return covering(ends, least=10.0)


def _band(effect: Effect) -> float | None:
    """Return the difference that is detected with 80 % power, where none is significant."""
    return None if effect.significant else effect.least_pp


def panel(title: str, rows: Sequence[Row], axis: Axis) -> Markup:
    """Return success of the repair minus success of the baseline, one row a label.

    A filled dot is a significant effect; the light band behind an open one reaches as far as the
    difference that is detected with 80 % power.
    """
    values = [e if isinstance(e, str) else wording.with_interval(e) for _, e in rows]
    described = "; ".join(f"{label}: {v}" for (label, _), v in zip(rows, values, strict=True))
    width, bottom = 350.0, _TOP + _PITCH * len(rows)
    name = f"{title}: success of the repair minus success of the baseline, percentage points"
    svg = Svg(width, bottom + 40, name, described)
    svg.text(0, 14, title, "head", room=width)
    plot = axis.at(8, width - _NUMBERS)
    _sides(svg, plot, 33)
    _grid(svg, plot, _TOP - 4, bottom)
    _tick_labels(svg, plot, bottom + 16)
    svg.text((plot.start + plot.end) / 2, bottom + 34, "difference, pp", "small soft", "middle")
    for index, ((label, effect), value) in enumerate(zip(rows, values, strict=True)):
        y, sign, note = _TOP + _PITCH * index, 0, ""
        if not isinstance(effect, str):
            sign, note = effect.sign, wording.reservation(effect)
        beside = text_width(note, 11)
        room = width - beside - 12
        left = text_width(shortened(label, room, 12), 12)
        svg.rect(0, y, left + (beside + 12 if note else 6), 20, "paper")
        svg.text(0, y + 14, label, room=room)
        if note:
            svg.text(left + 6, y + 14, note, "small soft")
        svg.text(width, y + 38, value, "bold" if sign else "", "end", room=width)
        if not isinstance(effect, str):
            _mark(svg, plot, effect, y + 34)
    return svg.render()


def _grid(svg: Svg, plot: Axis, top: float, bottom: float) -> None:
    for tick in plot.ticks(6):
        svg.line((plot(tick), top), (plot(tick), bottom), "zero" if tick == 0 else "axis")


def _tick_labels(svg: Svg, plot: Axis, y: float) -> None:
    for tick in plot.ticks(6):
        svg.text(plot(tick), y, tick_label(tick), "small soft", "middle")


def _sides(svg: Svg, plot: Axis, y: float) -> None:
    zero = plot(0.0)
    if zero - plot.start > 96:
        svg.text(zero - 8, y, "← baseline better", "small baseline", "end")
    if plot.end - zero > 88:
        svg.text(zero + 8, y, "repair better →", "small repair", "start")


def _mark(svg: Svg, plot: Axis, effect: Effect, y: float) -> None:
    """Draw dot, whiskers, a ring for each seed, and the undetectable band where one is given, in
    the colour of the variant that is significantly ahead."""
    e, band, side = effect, _band(effect), _SIDES.get(effect.sign, "")
    if band:
        svg.rect(plot(-band), y - 11, plot(band) - plot(-band), 22, "band", 2)
        for edge in (-band, band):
            svg.line((plot(edge), y - 11), (plot(edge), y + 11), "band-edge")
        svg.line((plot(0), y - 11), (plot(0), y + 11), "zero")
    if e.low is not None and e.high is not None:
        cls = f"range {side}".rstrip()
        svg.line((plot(e.low), y), (plot(e.high), y), cls)
        for end in (e.low, e.high):
            svg.line((plot(end), y - 4), (plot(end), y + 4), cls)
    if len(e.per_seed) > 1:
        for value in e.per_seed:
            svg.circle((plot(value), y + 10), 2.2, "seed")
    svg.circle((plot(e.value), y), 4.5, f"dot {side or 'open'}")


def share_panels(
    result: AuditResult, beta: bool = False
) -> tuple[list[tuple[Markup, str]], list[str]]:
    """Return the expected success difference over the frequency of the fault, or over the beta
    factor, a picture for each condition with a break-even, with what is significant there; and
    sentences on the other conditions.

    The band is the interval at each share, at the level that the family leaves. The thick line on
    zero is the set of shares at which neither variant is significantly ahead, the ring the estimate
    of the crossing. The curve has the colour of a variant where a sentence names that variant.
    """
    noun = "beta" if beta else "frequency"
    over = "faults that are common cause" if beta else "episodes with the fault"
    shares = [s for s in (result.break_even_beta if beta else result.break_even) if s.curve]
    ends = [end for share in filter(_crosses, shares) for _, *ends in share.curve for end in ends]
    vertical = covering(ends, 0.06, 10)
    panels: list[tuple[Markup, str]] = []
    others: list[str] = []
    for share in shares:
        title, even = result.titles[share.condition], share.result
        words = ahead(result.question, share, beta)
        if not _crosses(share):
            others.append(f"{title}: {words or f'no {noun} is significant'}.")
            continue
        words = words or f"No {noun} is significant"
        svg = Svg(290, 248, f"{title}: expected success difference, share of {over}", f"{words}.")
        svg.text(0, 14, title, "head", room=285)
        svg.text(0, 32, "expected difference in success, pp", "small soft")
        x, y = Axis(0.0, 100.0, 34, 280), vertical.at(208, 42)
        draw_axes(svg, x, y, 5, (0, 25, 50, 75, 100))
        svg.text(x(50), y.start + 34, f"share of {over}, %", "small soft", "middle")
        draw_band(svg, ((x(100 * p), y(low), y(high)) for p, _, low, high in share.curve))
        pieces = [(low, high, "curve") for low, high in even.pieces if share.ahead]
        pieces += [(r.low, r.high, f"curve {_SIDES[r.sign]}") for r in even.regions if share.ahead]
        first, last = share.curve[0][1], share.curve[-1][1]
        for low, high, cls in pieces or [(0.0, 1.0, "curve")]:
            line = [(x(100 * p), y((1 - p) * first + p * last)) for p in (low, high)]
            svg.polyline(line, cls)
        for low, high in even.pieces:
            svg.line((x(100 * low), y(0)), (x(100 * high), y(0)), "star-range")
        if even.p_star is not None and even.regions:
            at = wording.break_even(even)
            tip = f"no {noun} is significant" if at == "any" else f"not significant at {at} %"
            svg.circle((x(100 * even.p_star), y(0)), 5, "star", tip)
        if y(0) - y.end > _ROOM:
            svg.text(x.start + 6, y.end + 12, "repair better", "small repair halo")
        if y.start - y(0) > _ROOM:
            svg.text(x.start + 6, y.start - 6, "baseline better", "small baseline halo")
        panels.append((svg.render(), words))
    return panels, others


def _crosses(share: ConditionBreakEven) -> bool:
    """Return whether the estimate crosses zero, and some variant is significantly ahead."""
    at = share.result.p_star
    return at is not None and 0.0 < at < 1.0 and bool(share.result.regions)
