"""Effects with their intervals, condition by condition, and over the frequency of the fault."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from faultpath.analyses.effects import Effect
from faultpath.analyses.model import AuditResult, ConditionBreakEven
from faultpath.report.sentences import wording
from faultpath.report.sentences.phrases import ahead, in_short
from faultpath.report.svg import Axis, Svg, covering, draw_axes, shortened, text_width, tick_label

_PITCH, _TOP, _NUMBERS = 48.0, 44.0, 146.0
"""Height of a panel's row, where the first begins, and width of the column of numbers."""
_WIDE, _HIGH = 330.0, 42.0
"""Size of the picture of one effect, which stands in a table."""
_ROOM = 26.0
"""Pixels beside zero that a label of a side needs."""

Row = tuple[str, str, Effect | str]
"""A label, what stands beside it, and the effect or why there is none."""


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
    picture: str
    boxed: bool
    """Whether a grey box shows which differences could be missed."""


def effect_rows(record: AuditResult) -> list[EffectRow]:
    """Return a row for every condition, all pictures on one axis."""
    plot = shared_axis(record.effects).at(6, _WIDE - 6)
    rows: list[EffectRow] = []
    for condition in record.conditions:
        primary = "primary" if condition.name == record.facts.primary else ""
        effect = record.effect(condition.name)
        words = in_short(record, effect)
        svg = Svg(_WIDE, _HIGH, f"{condition.title}: repair minus baseline, pp")
        _grid(svg, plot, 0, _HIGH)
        if effect is None:
            rows.append(
                EffectRow(condition.title, primary, "", "", "open", words, svg.render(), False)
            )
            continue
        _mark(svg, plot, effect, _HIGH / 2)
        rows.append(
            EffectRow(
                title=condition.title,
                notes=", ".join(filter(None, (primary, wording.reservation(effect)))),
                rates=" → ".join(map(wording.plain, effect.rates)),
                difference=wording.with_interval(effect),
                side={1: "repair", -1: "baseline", 0: "open"}[effect.sign],
                words=words,
                picture=svg.render(),
                boxed=bool(_band(effect)),
            )
        )
    return rows


def effect_axis(record: AuditResult) -> str:
    """Return the axis below the pictures of `effect_rows`, with whose side is which."""
    plot = shared_axis(record.effects).at(6, _WIDE - 6)
    svg = Svg(_WIDE, 38, "Success of the repair minus success of the baseline, percentage points")
    _tick_labels(svg, plot, 12)
    _sides(svg, plot, 32)
    return svg.render()


def shared_axis(effects: Iterable[Effect]) -> Axis:
    """Return the axis that the pictures of effects have in common, percentage points."""
    ends: list[float] = []
    for e in effects:
        band = _band(e)
        ends += [v for v in (e.value, e.low, e.high, *e.per_seed) if v is not None]
        ends += [-band, band] if band else []
    return covering(ends, least=10.0)


def _band(effect: Effect) -> float | None:
    """Return the difference that is detected with 80 % power, where none is decided."""
    return None if effect.significant else effect.least_pp


def panel(title: str, rows: Sequence[Row], axis: Axis) -> str:
    """Return success of the repair minus success of the baseline, one row a label.

    A filled dot is a decided effect; the light band behind an open one reaches as far as the
    difference that is detected with 80 % power.
    """
    values = [e if isinstance(e, str) else wording.with_interval(e) for *_, e in rows]
    described = "; ".join(f"{row[0]}: {value}" for row, value in zip(rows, values, strict=True))
    width, bottom = 350.0, _TOP + _PITCH * len(rows)
    name = f"{title}: success of the repair minus success of the baseline, percentage points"
    svg = Svg(width, bottom + 40, name, described)
    svg.text(0, 14, title, "head", room=width)
    plot = axis.at(8, width - _NUMBERS)
    _sides(svg, plot, 33)
    _grid(svg, plot, _TOP - 4, bottom)
    _tick_labels(svg, plot, bottom + 16)
    svg.text((plot.start + plot.end) / 2, bottom + 34, "difference, pp", "small soft", "middle")
    for index, ((label, note, effect), value) in enumerate(zip(rows, values, strict=True)):
        y, sign = _TOP + _PITCH * index, 0
        if not isinstance(effect, str):
            note = ", ".join(filter(None, (note, wording.reservation(effect))))
            sign = effect.sign
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
    the colour of the variant that is decided for."""
    e, band = effect, _band(effect)
    side = {1: " repair", -1: " baseline", 0: ""}[effect.sign]
    if band:
        svg.rect(plot(-band), y - 11, plot(band) - plot(-band), 22, "band", 2)
        for edge in (-band, band):
            svg.line((plot(edge), y - 11), (plot(edge), y + 11), "band-edge")
        svg.line((plot(0), y - 11), (plot(0), y + 11), "zero")
    if e.low is not None and e.high is not None:
        svg.line((plot(e.low), y), (plot(e.high), y), "range" + side)
        for end in (e.low, e.high):
            svg.line((plot(end), y - 4), (plot(end), y + 4), "range" + side)
    if len(e.per_seed) > 1:
        for value in e.per_seed:
            svg.circle((plot(value), y + 10), 2.2, "seed")
    svg.circle((plot(e.value), y), 4.5, "dot" + side if side else "dot open")


def frequency_panels(record: AuditResult, beta: bool = False) -> list[tuple[str, str]]:
    """Return the expected success difference over the frequency of the fault, or over the beta
    factor, a picture for each condition with a break-even, and what is decided there.

    The band is the interval at each share, at the level that the family leaves. The thick line on
    zero is the set of shares at which neither variant is decided to be ahead, the ring the estimate
    of the crossing. The curve has the colour of a variant where a sentence names that variant.
    """
    noun = "beta" if beta else "frequency"
    over = "faults that are common cause" if beta else "episodes with the fault"
    with_curve = [share for share in _shares(record, beta) if _crosses(share)]
    vertical = covering(
        (v for share in with_curve for _, *ends in share.curve for v in ends), 0.06, 10
    )
    panels: list[tuple[str, str]] = []
    for share in with_curve:
        title, result = record.titles[share.condition], share.result
        words = ahead(record.question, share, beta) or f"No {noun} is significant"
        svg = Svg(290, 248, f"{title}: expected success difference, share of {over}", f"{words}.")
        svg.text(0, 14, title, "head", room=285)
        svg.text(0, 32, "expected difference in success, pp", "small soft")
        x, y = Axis(0.0, 100.0, 34, 280), vertical.at(208, 42)
        draw_axes(svg, x, y, 5, (0, 25, 50, 75, 100))
        svg.text(x(50), y.start + 34, f"share of {over}, %", "small soft", "middle")
        upper = [(x(100 * p), y(high)) for p, _, _, high in share.curve]
        lower = [(x(100 * p), y(low)) for p, _, low, _ in share.curve]
        svg.polygon([*upper, *reversed(lower)], "fan")
        sides = {1: "curve repair", -1: "curve baseline"}
        pieces = [(low, high, "curve") for low, high in result.pieces if share.ahead]
        pieces += [(r.low, r.high, sides[r.sign]) for r in result.regions if share.ahead]
        first, last = share.curve[0][1], share.curve[-1][1]
        for low, high, cls in pieces or [(0.0, 1.0, "curve")]:
            line = [(x(100 * p), y((1 - p) * first + p * last)) for p in (low, high)]
            svg.polyline(line, cls)
        for low, high in result.pieces:
            svg.line((x(100 * low), y(0)), (x(100 * high), y(0)), "star-range")
        if result.p_star is not None and result.regions:
            at = wording.break_even(result)
            tip = f"no {noun} is significant" if at == "any" else f"not significant at {at} %"
            svg.circle((x(100 * result.p_star), y(0)), 5, "star", tip)
        if y(0) - y.end > _ROOM:
            svg.text(x.start + 6, y.end + 12, "repair better", "small repair halo")
        if y.start - y(0) > _ROOM:
            svg.text(x.start + 6, y.start - 6, "baseline better", "small baseline halo")
        panels.append((svg.render(), words))
    return panels


def no_break_even(record: AuditResult, beta: bool = False) -> list[str]:
    """Say of each other condition what is decided there."""
    none = f"no {'beta' if beta else 'frequency'} is significant"
    return [
        f"{record.titles[share.condition]}: {ahead(record.question, share, beta) or none}."
        for share in _shares(record, beta)
        if not _crosses(share)
    ]


def _shares(record: AuditResult, beta: bool) -> list[ConditionBreakEven]:
    shares = record.break_even_beta if beta else record.break_even
    return [share for share in shares if share.curve]


def _crosses(share: ConditionBreakEven) -> bool:
    """Return whether the estimate crosses zero, and at some share it is decided who is ahead."""
    at = share.result.p_star
    return at is not None and 0.0 < at < 1.0 and bool(share.result.regions)
