"""The pictures of `docs/performance.md`, as SVG."""

import math
from collections.abc import Callable, Sequence

from benchmarks.results import Curve, Record
from benchmarks.words import number
from faultpath.report.scale import tick_label
from faultpath.report.svg import Svg, shortened

WIDTH = 880.0
NAMES = 330.0
ROW = 24.0
TOP = 46.0
RIGHT = WIDTH - 60.0
PANEL = 240.0
HEIGHT = 200.0


def ratios(records: Sequence[Record]) -> str:
    """Return bars of how many times as fast faultpath is, on a logarithmic axis, with targets."""
    shown = [r for r in records if r.ratio is not None and not _costs(r) and r.unit != "GFLOP/s"]
    top = max([10.0, *(r.ratio for r in shown if r.ratio is not None)])
    low, high = -1.0, math.ceil(math.log10(top))
    svg = Svg(
        WIDTH,
        TOP + ROW * len(shown) + 8,
        "How many times as fast faultpath is",
        "One bar a comparison; the tick on a bar's row is its target, the line at 1 is parity.",
    )

    def across(value: float) -> float:
        at = (math.log10(max(value, 0.1)) - low) / (high - low)
        return NAMES + at * (RIGHT - NAMES)

    svg.text(0, 16, "Times as fast as the software compared with; marks are targets", "head")
    for power in range(int(low), int(high) + 1):
        x = across(10.0**power)
        svg.line((x, TOP - 8), (x, TOP + ROW * len(shown)), "zero" if power == 0 else "axis")
        svg.text(x, TOP - 14, tick_label(10.0**power), "small soft", "middle")
    for i, record in enumerate(shown):
        _bar(svg, record, TOP + ROW * i, across)
    return svg.render(standalone=True)


def _bar(svg: Svg, record: Record, y: float, across: Callable[[float], float]) -> None:
    assert record.ratio is not None
    svg.text(0, y + 15, shortened(record.name, NAMES - 12, 12))
    one, end = across(1.0), across(record.ratio)
    look = {True: "success", False: "failed", None: "both"}[record.met]
    tip = f"{record.name}: {number(record.ratio)}"
    svg.rect(min(one, end), y + 4, abs(end - one), 14, look, tip=tip)
    right = max(one, end)
    if record.target is not None and record.target.of == "ratio":
        mark = across(record.target.value)
        svg.line((mark, y + 1), (mark, y + 21), "range")
        right = max(right, mark)
    svg.text(right + 6, y + 15, number(record.ratio), "small")


def _costs(record: Record) -> bool:
    """Return whether a record's ratio is one of costs, where less is better."""
    return (
        record.target is not None
        and record.target.of == "ratio"
        and record.target.sense == "at most"
    )


def scaling(curves: Sequence[Curve]) -> str:
    """Return a panel a curve, both axes logarithmic, with the line of proportional growth."""
    svg = Svg(
        WIDTH,
        HEIGHT + 70,
        "Time of a rollout over its size",
        "One panel a size; dots are medians, the thin line grows in proportion from the last dot.",
    )
    for i, curve in enumerate(curves):
        _panel(svg, curve, 40 + i * (PANEL + 50))
    return svg.render(standalone=True)


def _panel(svg: Svg, curve: Curve, left: float) -> None:
    sizes, times = zip(*curve.points, strict=True)
    low_x, high_x = math.log(sizes[0]), math.log(sizes[-1])
    low_y, high_y = math.log(min(times) / 1.3), math.log(max(times) * 1.3)

    def at(size: float, time: float) -> tuple[float, float]:
        x = left + (math.log(size) - low_x) / (high_x - low_x) * PANEL
        y = HEIGHT + 24 - (math.log(time) - low_y) / (high_y - low_y) * HEIGHT
        return x, y

    svg.text(left - 30, 14, f"Rollout, {curve.unit}", "head")
    bottom = HEIGHT + 24
    svg.line((left, bottom), (left + PANEL, bottom), "axis")
    svg.line((left, 24), (left, bottom), "axis")
    for size, time in curve.points:
        x, y = at(size, time)
        svg.text(x, bottom + 16, f"{size:g}", "small soft", "middle")
        svg.text(x, y - 9, number(time), "small", "middle")
    floor = max(sizes[0], sizes[-1] * math.exp(low_y) / times[-1])
    svg.line(at(floor, times[-1] * floor / sizes[-1]), at(sizes[-1], times[-1]), "seed")
    svg.polyline([at(size, time) for size, time in curve.points], "curve")
    for size, time in curve.points:
        svg.circle(
            at(size, time), 3, "dot", tip=f"{size:g} {curve.across}: {number(time)} {curve.unit}"
        )
    svg.text(left + PANEL / 2, bottom + 34, curve.across, "small soft", "middle")
