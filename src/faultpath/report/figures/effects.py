"""Effects with their intervals: the forest plot, and small panels for the secondary outcomes."""

from collections.abc import Sequence
from dataclasses import dataclass

from faultpath.record import wording
from faultpath.record.model import DecisionRecord
from faultpath.report.scale import Axis, covering, draw_interval, draw_uprights
from faultpath.report.svg import Svg, shortened, wrapped
from faultpath.statistics import Estimate

_PANEL = 290.0


@dataclass(frozen=True)
class EffectRow:
    """One path in the forest plot."""

    label: str
    baseline_percent: float
    repair_percent: float
    effect: Estimate
    wins_losses: str
    sign: int
    """Side that the family decides for: 1 the repair, -1 the baseline, 0 neither."""
    note: str
    """Whether it is the primary contrast, and what keeps it out of a headline."""
    band_pp: float | None
    """Difference that is found with 80 % power, where none is decided."""


def effect_rows(record: DecisionRecord) -> tuple[EffectRow, ...]:
    """Return the rows of the forest plot in the order of the record's paths."""
    titles = {path.name: path.title for path in record.paths}
    asked = record.question
    primary = {effect.path: "" for effect in record.effects} | {asked.primary: "primary"}
    return tuple(
        EffectRow(
            label=titles.get(effect.path, effect.path),
            baseline_percent=effect.baseline_percent,
            repair_percent=effect.repair_percent,
            effect=effect.success,
            wins_losses=wording.wins_losses(effect.wins, effect.losses),
            sign=effect.sign,
            note=", ".join(filter(None, (primary[effect.path], wording.reservation(effect)))),
            band_pp=None if effect.detected else effect.findable_pp,
        )
        for effect in record.effects
    )


def forest(rows: Sequence[EffectRow], baseline: str, repair: str, narrow: bool = False) -> str:
    """Return the forest plot of the success differences, percentage points, one row a path.

    `narrow` stacks the columns for a telephone. A filled dot is an effect that the family decides;
    the light band behind an open one reaches as far as the difference found with 80 % power.
    """
    told = "; ".join(f"{r.label}: {wording.with_interval(r.effect)} pp" for r in rows)
    title = f"Success of {repair} minus success of {baseline}, percentage points"
    axis = covering(extent(rows), least=10.0)
    return (_narrow if narrow else _wide)(rows, axis, title, told).render()


def _wide(rows: Sequence[EffectRow], axis: Axis, title: str, told: str) -> Svg:
    top, pitch = 52.0, 46.0
    bottom = top + pitch * len(rows)
    svg = Svg(880, bottom + 46, title, told)
    plot = axis.at(292, 592)
    draw_uprights(svg, plot, top - 8, bottom, 6)
    svg.text(266, 20, "success, %", "small soft", "end")
    for x, words in ((214, "baseline"), (266, "repair")):
        svg.text(x, 34, words, f"small {words}", "end")
    svg.text(612, 20, "difference, pp", "small soft")
    svg.text(612, 34, "[95 % interval]" if _all_95(rows) else "[interval]", "small soft")
    svg.text(768, 20, "scenes won : lost", "small soft")
    svg.text(
        768, 34, "by the repair" + (", by seed" if "/" in rows[0].wins_losses else ""), "small soft"
    )
    directions(svg, plot, 34)
    for i, row in enumerate(rows):
        y = top + pitch * (i + 0.5)
        lines = wrapped(row.label, 146, 12, 2)
        last = len(lines) - (0 if row.note else 1)
        for k, line in enumerate(lines):
            svg.text(0, y + 4 + 15 * (k - last / 2), line, "bold", tip=row.label)
        if row.note:
            svg.text(0, y + 4 + 15 * (last / 2), row.note, "small soft")
        svg.text(214, y + 4, wording.plain(row.baseline_percent), "", "end")
        svg.text(266, y + 4, wording.plain(row.repair_percent), "", "end")
        mark(svg, plot, row.effect, y, row.sign, row.band_pp)
        _numbers(svg, 612, y + 4, row)
        svg.text(768, y + 4, row.wins_losses)
    _footnote(svg, rows, bottom + 40, 292)
    return svg


def _narrow(rows: Sequence[EffectRow], axis: Axis, title: str, told: str) -> Svg:
    top, pitch = 24.0, 84.0
    bottom = top + pitch * len(rows)
    svg = Svg(350, bottom + 46, title, told)
    plot = axis.at(14, 336)
    draw_uprights(svg, plot, top - 4, bottom, 6)
    directions(svg, plot, 12)
    for i, row in enumerate(rows):
        y = top + pitch * i
        with svg.group():
            svg.rect(0, y + 2, 350, 20, "paper")
            svg.text(0, y + 16, shortened(row.label, 195, 12), "bold", tip=row.label)
            svg.text(350, y + 16, wording.with_interval(row.effect), "", "end")
        mark(svg, plot, row.effect, y + 38, row.sign, row.band_pp)
        rates = f"{wording.plain(row.baseline_percent)} → {wording.plain(row.repair_percent)} %"
        svg.rect(0, y + 54, 350, 18, "paper")
        svg.text(0, y + 67, f"{rates}{f', {row.note}' if row.note else ''}", "small soft")
        svg.text(350, y + 67, f"won : lost  {row.wins_losses}", "small soft", "end")
    _footnote(svg, rows, bottom + 40, 0)
    return svg


def secondary_panel(
    title: str, unit: str, rows: Sequence[tuple[str, Estimate | None]], good: str, digits: int = 2
) -> str:
    """Return the intervals of one secondary outcome over the paths.

    Nothing is decided from it, so no mark is filled or coloured. `good` says what is better, such
    as `less`.
    """
    told = "; ".join(f"{label}: {wording.with_interval(e, digits)} {unit}" for label, e in rows)
    present = [e for _, e in rows if e is not None]
    ends = [v for e in present for v in (e.value, e.low, e.high) if v is not None]
    pitch, top = 48.0, 44.0
    bottom = top + pitch * len(rows)
    svg = Svg(_PANEL, bottom + 24, f"{title}: repair minus baseline, {unit}", told)
    svg.text(0, 14, f"{title}, {unit}", "head")
    svg.text(0, 31, f"secondary; {good} is better", "small soft")
    plot = covering(ends, least=10.0**-digits).at(15, _PANEL - 15)
    draw_uprights(svg, plot, top, bottom, 4)
    for i, (label, estimate) in enumerate(rows):
        y = top + pitch * i
        svg.rect(0, y + 5, _PANEL, 18, "paper")
        svg.text(0, y + 18, shortened(label, _PANEL - 140, 12), tip=label)
        svg.text(_PANEL, y + 18, wording.with_interval(estimate, digits), "", "end")
        if estimate is not None:
            _secondary_mark(svg, plot, estimate, y + 35)
    return svg.render()


def _secondary_mark(svg: Svg, plot: Axis, e: Estimate, y: float) -> None:
    """Draw an interval with a tick for its estimate, in the ink of what is not decided."""
    if e.low is not None and e.high is not None:
        svg.line((plot(e.low), y), (plot(e.high), y), "seed")
    svg.line((plot(e.value), y - 5), (plot(e.value), y + 5), "seed")


def extent(rows: Sequence[EffectRow]) -> list[float]:
    """Return all that an axis for these effects has to cover."""
    ends: list[float] = []
    for row in rows:
        ends += [v for v in (row.effect.value, row.effect.low, row.effect.high) if v is not None]
        ends += row.effect.per_seed or ()
        ends += [-row.band_pp, row.band_pp] if row.band_pp else []
    return ends


def _all_95(rows: Sequence[EffectRow]) -> bool:
    return all(abs(row.effect.level - 0.95) < 1e-9 for row in rows)


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


def _numbers(svg: Svg, x: float, y: float, row: EffectRow) -> None:
    """Write difference and interval; bold is decided, as in every table."""
    svg.text(x + 34, y, wording.signed(row.effect.value), "bold" if row.sign else "", "end")
    svg.text(x + 42, y, wording.interval(row.effect))


def _footnote(svg: Svg, rows: Sequence[EffectRow], y: float, x: float) -> None:
    notes: list[str] = []
    if any(row.band_pp for row in rows):
        notes.append("shaded: found with less than 80 % power")
    if any(len(row.effect.per_seed or ()) > 1 for row in rows):
        notes.append("ticks: single seeds")
    if notes:
        svg.text(x, y, " · ".join(notes), "small soft")
