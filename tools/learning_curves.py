"""Panels of curves that carry their labels at their ends."""

from collections.abc import Sequence
from dataclasses import dataclass

from faultpath.report.scale import Axis, tick_label
from faultpath.report.svg import Point, Svg

# A model has the same look in every picture: one colour a family, dashes for its variant. The
# report's tokens are used as plain colours here, because they are legible on light and dark.
LOOKS: dict[str, tuple[str, bool]] = {
    "dki": ("soft", False),
    "dki-drag": ("soft", True),
    "true-parameter": ("ink", False),
    "wm-a": ("repair", False),
    "wm-a+dcc": ("repair", True),
    "wm-u": ("baseline", False),
    "wm-u+dcc": ("baseline", True),
    "wm-a-wind": ("repair", False),
    "wm-a-wind, zero wind": ("repair", True),
    "wm-a-nowind": ("baseline", False),
    "dob": ("ink", False),
    "gru": ("repair", False),
    "gru+dcc": ("repair", True),
    "gru-withheld": ("baseline", False),
    "gru-trajectory": ("baseline", True),
}

PITCH = 15.0
"""Least distance of two labels, pixels."""
HEIGHT = 250.0
BOTTOM = HEIGHT + 40.0
LABELS = 160.0
"""Room for the labels to the right of a panel."""
_LEADER = 18.0


@dataclass(frozen=True)
class Curve:
    """The curve of one model: the mean over its seeds, and each seed where there are several."""

    label: str
    points: Sequence[Point]
    seeds: Sequence[Sequence[Point]] = ()


@dataclass(frozen=True)
class Panel:
    """Curves over one axis."""

    title: str
    below: str
    """What the horizontal axis shows."""
    ticks: Sequence[tuple[float, str]]
    curves: Sequence[Curve]
    dots: bool = True
    """Whether each point is marked."""
    high: float | None = None
    """Upper end of the vertical axis; by default what the curves need."""


def top_of(curves: Sequence[Curve]) -> float:
    """Return the largest value of some curves and of their seeds."""
    return max((y for c in curves for part in (c.points, *c.seeds) for _, y in part), default=1.0)


def draw(svg: Svg, panel: Panel, left: float, right: float) -> None:
    """Draw a panel between two horizontal pixels, its labels to the right of them."""
    places = [x for curve in panel.curves for x, _ in curve.points] or [0.0, 1.0]
    if min(places) == max(places):
        places += [place for place, _ in panel.ticks]
    values = [y for c in panel.curves for part in (c.points, *c.seeds) for _, y in part]
    low = min(0.0, *values) if values else 0.0
    high = panel.high or top_of(panel.curves)
    pad = 0.04 * (high - low)
    across = Axis(min(places), max(places), left, right)
    up = Axis(low - (pad if low < 0 else 0), high + pad, HEIGHT, 36.0)
    svg.text(left - 30, 14, panel.title, "head")
    _frame(svg, panel, across, up)
    for curve in panel.curves:
        _curve(svg, curve, across, up, panel.dots)
    _labels(svg, panel.curves, across, up)


def _frame(svg: Svg, panel: Panel, across: Axis, up: Axis) -> None:
    for tick in up.ticks(5):
        svg.line((across.start, up(tick)), (across.end, up(tick)), "axis" if tick else "zero")
        svg.text(across.start - 7, up(tick) + 4, tick_label(round(tick, 9)), "small soft", "end")
    for value, text in panel.ticks:
        svg.line((across(value), HEIGHT), (across(value), HEIGHT + 4), "axis")
        svg.text(across(value), HEIGHT + 18, text, "small soft", "middle")
    middle = 0.5 * (across.start + across.end)
    svg.text(middle, BOTTOM - 4, panel.below, "small soft", "middle")


def _curve(svg: Svg, curve: Curve, across: Axis, up: Axis, dots: bool) -> None:
    colour, dashed = LOOKS[curve.label]
    stroke = f"stroke:var(--{colour})"
    if len(curve.seeds) > 1:
        for seed in curve.seeds:
            svg.path(_line(seed, across, up), "curve", style=f"{stroke};stroke-width:1;opacity:.4")
    dashes = ";stroke-dasharray:6 4" if dashed else ""
    svg.path(_line(curve.points, across, up), "curve", style=stroke + dashes)
    if not dots:
        return
    with svg.group(style=f"fill:var(--{colour})"):
        for x, y in curve.points:
            tip = f"{curve.label}: {y:.3g}"
            svg.circle((across(x), up(y)), 3, "", tip)


def _line(points: Sequence[Point], across: Axis, up: Axis) -> str:
    return "M" + " L".join(f"{across(x):.2f},{up(y):.2f}" for x, y in points)


def _labels(svg: Svg, curves: Sequence[Curve], across: Axis, up: Axis) -> None:
    """Write every label beside its curve's end, pushed apart where ends lie close."""
    ordered = sorted(curves, key=lambda curve: up(curve.points[-1][1]))
    ends = [up(curve.points[-1][1]) for curve in ordered]
    for curve, end, place in zip(ordered, ends, spread(ends), strict=True):
        colour, dashed = LOOKS[curve.label]
        near, far = across.end + 5, across.end + 5 + _LEADER
        dashes = ";stroke-dasharray:4 3" if dashed else ""
        svg.path(
            f"M{near:.2f},{end:.2f} L{far:.2f},{place:.2f}",
            "curve",
            style=f"stroke:var(--{colour});stroke-width:1{dashes}",
        )
        svg.text(far + 4, place + 4, curve.label, "" if colour == "ink" else colour)


def spread(ends: Sequence[float]) -> list[float]:
    """Return places at least `PITCH` apart, in the order of `ends` (ascending), close to them."""
    groups: list[tuple[float, int]] = []  # middle and size of runs of touching labels
    for end in ends:
        groups.append((end, 1))
        while len(groups) > 1 and _touch(*groups[-2:]):
            (one, n), (two, k) = groups[-2:]
            groups[-2:] = [((one * n + two * k) / (n + k), n + k)]
    return [middle + PITCH * (i - (size - 1) / 2) for middle, size in groups for i in range(size)]


def _touch(above: tuple[float, int], below: tuple[float, int]) -> bool:
    return below[0] - above[0] < PITCH * (above[1] + below[1]) / 2
