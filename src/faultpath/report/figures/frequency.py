"""What the repair is worth at each fault frequency, and where it breaks even."""

from collections.abc import Sequence

from faultpath.record import wording
from faultpath.record.model import PathBreakEven
from faultpath.report.scale import Axis, covering, draw_levels, draw_tick
from faultpath.report.svg import Point, Svg, shortened, wrapped

_ROOM = 26.0  # pixels beside zero that a label of a side needs


def shared_range(paths: Sequence[PathBreakEven]) -> Axis:
    """Return one vertical axis that all panels share, so that they can be compared by eye."""
    values = [v for path in paths for _, *ends in path.curve for v in ends]
    return covering(values, least=10.0)


def frequency_panel(path: PathBreakEven, title: str, vertical: Axis) -> str:
    """Return the expected success difference over the fault frequency for one path.

    The band is the interval at each frequency, at the level that the family leaves. The thick line
    on zero is the set of frequencies at which nobody is decided to be ahead, the ring the estimate
    of the crossing, where any frequency is decided. The curve has the colour of an arm where that
    arm is decided to be ahead.
    """
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
    if not path.curve:
        return svg.render()
    upper = [(x(p), y(high)) for p, _, _, high in path.curve]
    lower = [(x(p), y(low)) for p, _, low, _ in path.curve]
    svg.polygon([*upper, *reversed(lower)], "fan")
    _curve(svg, path, x, y)
    tip = "no frequency is decided" if shown == "any" else f"not decided at {shown}"
    _set(svg, path, x, y, tip)
    if y(0) - y.end > _ROOM:
        svg.text(x.start + 6, y.end + 12, "repair better", "small repair halo")
    if y.start - y(0) > _ROOM:
        svg.text(x.start + 6, y.start - 6, "baseline better", "small baseline halo")
    return svg.render()


def _curve(svg: Svg, path: PathBreakEven, x: Axis, y: Axis) -> None:
    """Draw the expected difference, in an arm's colour only where something is said of it."""
    first, last = path.curve[0][1], path.curve[-1][1]

    def point(p: float) -> Point:
        return x(p), y((1 - p) * first + p * last)

    if not path.words:
        svg.polyline([point(0.0), point(1.0)], "curve")
        return
    for low, high in path.result.pieces:
        svg.polyline([point(low), point(high)], "curve")
    for region in path.result.regions:
        side = "repair" if region.sign > 0 else "baseline"
        svg.polyline([point(region.low), point(region.high)], f"curve {side}")


def _set(svg: Svg, path: PathBreakEven, x: Axis, y: Axis, tip: str) -> None:
    result = path.result
    for low, high in result.pieces:
        svg.line((x(low), y(0)), (x(high), y(0)), "star-range")
    if result.p_star is not None and result.regions:
        svg.circle((x(result.p_star), y(0)), 5, "star", tip=tip)
