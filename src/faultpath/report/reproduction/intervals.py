"""Estimates with their intervals, small enough to stand in a line of text."""

from collections.abc import Sequence

from faultpath.report.scale import Axis, covering, draw_interval, tick_label
from faultpath.report.svg import Svg

WIDTH = 150.0
_HEIGHT, _LABELLED = 20.0, 31.0


def plot_axis(ends: list[float]) -> Axis:
    """Return an axis over the width of a plot that covers 0 and `ends`."""
    span = max(map(abs, ends), default=0.0)
    return covering(ends, margin=0.04, least=1e-3 * span or 1.0).at(5, WIDTH - 5)


def scale_plot(axis: Axis, title: str) -> str:
    """Return the labelled scale that stands over plots that share an axis."""
    svg = Svg(WIDTH, 16, title)
    for tick in _ends_of(axis):
        svg.text(axis(tick), 11, tick_label(tick), "tiny", "middle")
        svg.line((axis(tick), 13), (axis(tick), 16), "zero")
    return svg.render()


def interval_plot(
    title: str,
    value: float,
    interval: Sequence[float],
    least_detectable: float | None,
    shared: Axis | None,
    papers: Sequence[float] = (),
) -> str:
    """Return one interval: filled where it leaves out 0, open elsewhere.

    `papers`: the paper's figure, and the ends of its interval where it has one, marked above.
    The light band beside an open one reaches as far as effects that would probably not have been
    detected. Without a `shared` axis the plot gets one of its own, with two labels.
    """
    low, high = interval
    open_ = low <= 0 <= high
    band = least_detectable if open_ else None
    axis = shared or plot_axis([value, low, high, *papers, *((-band, band) if band else ())])
    svg = Svg(WIDTH, _HEIGHT if shared else _LABELLED, title)
    y = _HEIGHT / 2
    if band:
        left, right = max(axis(-band), 0.0), min(axis(band), WIDTH)
        svg.rect(left, y - 8, right - left, 16, "band", 2)
    svg.line((0, y), (WIDTH, y), "axis")
    svg.line((axis(0.0), 0), (axis(0.0), _HEIGHT), "zero")
    draw_interval(svg, axis, interval, y, 3.5, "range")
    svg.circle((axis(value), y), 3.8, "dot open" if open_ else "dot")
    if papers:
        at, *theirs = map(axis, papers)
        if theirs:
            svg.line((theirs[0], 2), (theirs[1], 2), "papers")
        svg.polygon([(at - 3, 0), (at + 3, 0), (at, 5)], "papers-figure")
    if not shared:
        for tick in _ends_of(axis):
            svg.text(axis(tick), _LABELLED - 2, tick_label(tick), "tiny", "middle")
    return svg.render()


def _ends_of(axis: Axis) -> list[float]:
    """Return 0 and the outermost round numbers beside it whose labels stand free of it."""
    ticks = [round(tick, 12) for tick in axis.ticks(3)]
    outer = [tick for tick in (ticks[0], ticks[-1]) if abs(axis(tick) - axis(0.0)) > 22]
    return sorted({0.0, *outer})
