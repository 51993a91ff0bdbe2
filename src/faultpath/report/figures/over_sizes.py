"""The effect on one path over the size of the fault: small panels that share both axes."""

from faultpath.record import wording
from faultpath.report.comparison.sweep import Swept
from faultpath.report.figures.effects import EffectRow
from faultpath.report.figures.multiples import Rows
from faultpath.report.scale import Axis, draw_levels, draw_tick, tick_label
from faultpath.report.svg import Svg, shortened, text_width

_WIDTH, _LEFT, _TOP, _HEIGHT = 350.0, 34.0, 46.0, 190.0


def over_sizes(title: str, sizes: Swept, rows: Rows, axis: Axis) -> str:
    """Return the panel of one path: success of the repair minus that of the baseline over sizes.

    Dots, whiskers and shading are those of the forest plot, turned upright. `axis` is that of the
    differences, percentage points. A size whose pairs are all void has no dot.
    """
    told = "; ".join(
        f"{tick_label(size)}: {row if isinstance(row, str) else wording.with_interval(row.effect)}"
        for size, (_, row) in zip(sizes.sizes, rows, strict=True)
    )
    bottom = _TOP + _HEIGHT
    name = f"{title}: success of the repair minus success of the baseline, percentage points"
    svg = Svg(_WIDTH, bottom + 40, f"{name}, over the size of {sizes.name}", told)
    svg.text(0, 14, shortened(title, _WIDTH, 13), "head", tip=title)
    x = _across(sizes)
    y = axis.at(bottom, _TOP)
    svg.text(_LEFT, 36, "↑ repair better, pp", "small repair")
    svg.text(_WIDTH, 36, "↓ baseline better, pp", "small baseline", "end")
    draw_levels(svg, x, y, 6, "zero")
    present = [
        (x(size), row)
        for size, (_, row) in zip(sizes.sizes, rows, strict=True)
        if isinstance(row, EffectRow)
    ]
    for at, row in present:
        _band(svg, at, y, row.band_pp)
    svg.line((x.start, y(0.0)), (x.end, y(0.0)), "zero")
    course = sorted((at, y(row.effect.value)) for at, row in present)
    svg.polyline(course, "course")
    for at, row in present:
        _mark(svg, at, y, row)
    _sizes(svg, x, y, sizes)
    svg.text((x.start + x.end) / 2, bottom + 35, f"size of {sizes.name}", "small soft", "middle")
    return svg.render()


def _across(sizes: Swept) -> Axis:
    low, high = min(sizes.sizes), max(sizes.sizes)
    pad = 0.06 * (high - low)
    return Axis(low - pad, high + pad, _LEFT, _WIDTH)


def _band(svg: Svg, at: float, y: Axis, band_pp: float | None) -> None:
    if band_pp:
        svg.rect(at - 6, y(band_pp), 12, y(-band_pp) - y(band_pp), "band", 2)


def _mark(svg: Svg, at: float, y: Axis, row: EffectRow) -> None:
    side = {1: " repair", -1: " baseline", 0: ""}[row.sign]
    low, high = row.effect.low, row.effect.high
    if low is not None and high is not None:
        svg.line((at, y(low)), (at, y(high)), "range" + side)
        for end in (low, high):
            svg.line((at - 4, y(end)), (at + 4, y(end)), "range" + side)
    tip = wording.with_interval(row.effect) + (f", {row.note}" if row.note else "")
    svg.circle((at, y(row.effect.value)), 4.5, "dot" + side if side else "dot open", tip)


def _sizes(svg: Svg, x: Axis, y: Axis, sizes: Swept) -> None:
    """Label the sizes that there are, as far as labels stand free of each other."""
    right = -1.0
    for size in sorted(sizes.sizes):
        label = tick_label(size)
        half = text_width(label, 11) / 2
        if x(size) - half > right:
            draw_tick(svg, x, y, size, label)
            right = x(size) + half + 6
