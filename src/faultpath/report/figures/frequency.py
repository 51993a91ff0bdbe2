"""What the repair is worth at each fault frequency, and where it breaks even."""

from collections.abc import Sequence
from itertools import pairwise

from faultpath.record.model import PathBreakEven
from faultpath.report import wording
from faultpath.report.scale import Axis, covering, tick_label
from faultpath.report.svg import Point, Svg, shortened

_ROOM = 26.0  # pixels beside zero that a label of a side needs


def shared_range(paths: Sequence[PathBreakEven]) -> Axis:
    """Return one vertical axis that all panels share, so that they can be compared by eye."""
    values = [v for path in paths for _, *ends in path.curve for v in ends]
    return covering(values, least=10.0)


def frequency_panel(path: PathBreakEven, title: str, vertical: Axis) -> str:
    """Return the expected success difference over the fault frequency for one path.

    The band is the record's interval at each frequency. The thick line on the zero line is where
    the band holds 0: there it is not decided who is ahead. The ring is the point estimate.
    """
    words = wording.break_even_sentence(path.result)
    svg = Svg(290, 250, f"{title}: expected success difference against fault frequency", words)
    svg.text(0, 14, shortened(title, 285, 13), "head", tip=title)
    svg.text(0, 31, words, "small soft")
    x, y = Axis(0.0, 1.0, 34, 280), vertical.at(210, 44)
    _axes(svg, x, y)
    if not path.curve:
        return svg.render()
    upper = [(x(p), y(high)) for p, _, _, high in path.curve]
    lower = [(x(p), y(low)) for p, _, low, _ in path.curve]
    svg.polygon([*upper, *reversed(lower)], "fan")
    for points, side in _sides([(p, value) for p, value, _, _ in path.curve]):
        svg.polyline([(x(p), y(v)) for p, v in points], f"curve {side}")
    _star(svg, path, x, y)
    if y(0) - y.end > _ROOM:
        svg.text(x.start + 6, y.end + 12, "repair better", "small repair halo")
    if y.start - y(0) > _ROOM:
        svg.text(x.start + 6, y.start - 6, "baseline better", "small baseline halo")
    return svg.render()


def _axes(svg: Svg, x: Axis, y: Axis) -> None:
    for tick in y.ticks(5):
        cls = "zero" if tick == 0 else "axis"
        svg.line((x.start, y(tick)), (x.end, y(tick)), cls)
        svg.text(x.start - 6, y(tick) + 4, tick_label(tick), "small soft", "end")
    for percent in (0, 25, 50, 75, 100):
        at = x(percent / 100)
        svg.line((at, y.start), (at, y.start + 4), "axis")
        svg.text(at, y.start + 17, str(percent), "small soft", "middle")
    svg.text(x(0.5), y.start + 34, "episodes with the fault, %", "small soft", "middle")


def _sides(curve: Sequence[Point]) -> list[tuple[list[Point], str]]:
    """Cut the curve at its zeros, so that each piece can be drawn by who is better on it."""
    pieces: list[tuple[list[Point], str]] = []
    piece = [curve[0]]
    for (p0, v0), (p1, v1) in pairwise(curve):
        if v0 * v1 < 0:
            zero = (p0 + (p1 - p0) * v0 / (v0 - v1), 0.0)
            pieces.append(([*piece, zero], _side(piece)))
            piece = [zero]
        piece.append((p1, v1))
    return [*pieces, (piece, _side(piece))]


def _side(piece: Sequence[Point]) -> str:
    total = sum(v for _, v in piece)
    return "repair" if total > 0 else "baseline" if total < 0 else ""


def _star(svg: Svg, path: PathBreakEven, x: Axis, y: Axis) -> None:
    result = path.result
    for low, high in result.pieces:
        svg.line((x(low), y(0)), (x(high), y(0)), "star-range")
    if result.p_star is None:
        return
    svg.circle((x(result.p_star), y(0)), 5, "star", tip=wording.break_even_sentence(result))
