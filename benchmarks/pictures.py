"""The pictures of `docs/performance.md`, as SVG."""

import math
from collections.abc import Sequence

from benchmarks.results import Curve, Record
from faultpath.report.scale import Axis, tick_label
from faultpath.report.svg import Point, Svg, shortened

WIDTH = 880.0
NAMES = 330.0
ROW = 24.0
TOP = 58.0
RIGHT = WIDTH - 60.0
PANEL = 240.0
HEIGHT = 200.0


def ratios(records: Sequence[Record]) -> str:
    """Return bars of how many times as fast faultpath is, on a logarithmic axis, with targets."""
    shown = {r: r.ratio for r in records if r.ratio and not _costs(r) and r.unit != "GFLOP/s"}
    high = math.ceil(math.log10(max([10.0, *shown.values()])))
    across = Axis(-1.0, high, NAMES, RIGHT)
    bottom = TOP + ROW * len(shown)
    svg = Svg(
        WIDTH,
        bottom + 8,
        "How many times as fast faultpath is",
        "One bar a comparison; the mark on a bar's row is its target; at 1 both are as fast.",
    )
    svg.text(0, 16, "How many times as fast faultpath is as the software beside it", "head")
    svg.text(0, TOP - 14, "1: as fast as the other; marks: targets", "small soft")
    for power in range(-1, high + 1):
        x = across(power)
        svg.line((x, TOP - 8), (x, bottom), "zero" if power == 0 else "axis")
        svg.text(x, TOP - 14, tick_label(10.0**power), "small soft", "middle")
    for i, (record, ratio) in enumerate(shown.items()):
        y = TOP + ROW * i
        svg.text(0, y + 15, shortened(_named(record), NAMES - 12, 12), tip=_named(record))
        one, end = across(0.0), across(math.log10(max(ratio, 0.1)))
        look = {True: "success", False: "failed", None: "both"}[record.met]
        tip = f"{record.name}: {number(ratio)}"
        svg.rect(min(one, end), y + 4, abs(end - one), 14, look, tip=tip)
        right = max(one, end)
        if record.target is not None and record.target.of == "ratio":
            mark = across(math.log10(record.target.value))
            svg.line((mark, y + 1), (mark, y + 21), "range")
            right = max(right, mark)
        svg.text(right + 6, y + 15, number(ratio), "small")
    return svg.render(standalone=True)


def _named(record: Record) -> str:
    peer = record.peer_name
    said = not peer or peer.split()[0].strip(",") in record.name
    return record.name if said else f"{record.name}, {peer}"


def _costs(record: Record) -> bool:
    target = record.target
    return target is not None and (target.of, target.sense) == ("ratio", "at most")


def scaling(curves: Sequence[Curve]) -> str:
    """Return a panel a curve, both axes logarithmic, with the line of proportional growth."""
    svg = Svg(
        WIDTH,
        HEIGHT + 84,
        "Time of one rollout over its size",
        "One panel a size; dots are medians, the thin line grows in proportion from the last dot.",
    )
    note = "Both axes are logarithmic; the thin line grows in proportion to the size."
    svg.text(0, HEIGHT + 78, note, "small soft")
    for i, curve in enumerate(curves):
        _panel(svg, curve, 40 + i * (PANEL + 50))
    return svg.render(standalone=True)


def _panel(svg: Svg, curve: Curve, left: float) -> None:
    sizes, times = zip(*curve.points, strict=True)
    bottom, right = HEIGHT + 24, left + PANEL
    across = Axis(math.log(sizes[0]), math.log(sizes[-1]), left, right)
    up = Axis(math.log(min(times) / 1.3), math.log(max(times) * 1.3), bottom, 24)

    def at(size: float, time: float) -> Point:
        return across(math.log(size)), up(math.log(time))

    svg.text(left - 30, 14, f"Time of one rollout, {curve.unit}", "head")
    svg.line((left, bottom), (right, bottom), "axis")
    svg.line((left, 24), (left, bottom), "axis")
    for size, time in curve.points:
        x, y = at(size, time)
        svg.text(x, bottom + 16, f"{size:g}", "small soft", "middle")
        svg.text(x, y - 9, number(time), "small", "middle")
    floor = max(sizes[0], sizes[-1] * math.exp(up.low) / times[-1])
    svg.line(at(floor, times[-1] * floor / sizes[-1]), at(sizes[-1], times[-1]), "seed")
    svg.polyline([at(*point) for point in curve.points], "curve")
    for size, time in curve.points:
        tip = f"{size:g} {curve.across}: {number(time)} {curve.unit}"
        svg.circle(at(size, time), 3, "dot", tip=tip)
    svg.text(left + PANEL / 2, bottom + 34, curve.across, "small soft", "middle")


def number(value: float) -> str:
    """Return three significant digits, thousands apart."""
    if value >= 1000:
        digits = 10 ** (len(str(int(value))) - 3)
        return f"{round(value / digits) * digits:,}".replace(",", " ")
    return f"{value:.3g}"
