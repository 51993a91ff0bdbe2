"""A map as tables, pictures, terminal and page; all numbers are the result's."""

from collections.abc import Iterator
from itertools import pairwise, product
from pathlib import Path

from faultpath.analyses.map.model import MapResult
from faultpath.analyses.model import SHARED
from faultpath.core.text import counted
from faultpath.report.frame import render, write_pages
from faultpath.report.sentences import wording, words
from faultpath.report.sentences.maps import at_point, headline, size_label
from faultpath.report.sentences.phrases import scenes_like_these
from faultpath.report.svg import (
    Axis,
    Point,
    Svg,
    covering,
    draw_axes,
    draw_band,
    draw_scale,
    number,
    shade,
    text_width,
    tick_label,
)
from faultpath.report.tables import Entry, Line, Table, html, line, markdown_blocks
from faultpath.run.provenance import RunProvenance
from faultpath.stats.power import MIN_SCENES

_SIDE = 340.0
"""Side of the square, in pixels."""
_LEFT, _RIGHT, _TOP = 40.0, 112.0, 168.0
_EQUAL = "0: both succeed equally often"


def tables(result: MapResult) -> tuple[Table, ...]:
    """Return how large an error reverses the ranking, and the differences at one or equal errors.

    With too few scenes for a significant difference there is no ranking that could reverse.
    """
    flips = (_flips(result),) if result.scenes >= MIN_SCENES else ()
    return *flips, _conditions(result)


def _conditions(result: MapResult) -> Table:
    question, facts = result.question, result.facts
    points = {point.errors: point for point in result.points}
    lines: list[Line] = []
    for size in sorted({x or y for x, y in points if x == y or not x or not y}):
        entries: list[Entry] = []
        for errors in ((size, 0.0), (0.0, size), (size, size)):
            entry = Entry(text="not run")
            if point := points.get(errors):
                text = f"{wording.signed(point.difference)} {wording.interval(point)}"
                entry = Entry(text=text, detected=point.sign != 0)
            entries.append(entry)
        lines.append(line(size_label(facts, size), *entries))
    return Table(
        name="conditions",
        title=f"{question.repair} minus {question.baseline}, success, pp",
        corner="Error",
        columns=(*(f"{name} alone" for name in facts.modules), "shared"),
        lines=tuple(lines),
        notes=(
            f"{counted(result.scenes, 'scene')} of {facts.library}, "
            f"{wording.seeds(question.seeds)}. Intervals hold at all {len(result.points)} pairs of "
            "errors at once. Significant: the interval leaves out 0, and a sign test agrees.",
        ),
    )


def _flips(result: MapResult) -> Table:
    facts = result.facts
    lines: list[Line] = []
    for flip in result.flips:
        before = beyond = "neither"
        if flip.start and flip.until is not None:
            before = f"{result.winner(flip.start)}, {size_label(facts, flip.until)}"
        if flip.turned and flip.first is not None and flip.last is not None:
            beyond = f"{result.winner(flip.turned)}, {size_label(facts, flip.first)}"
            if abs(flip.last) < facts.up_to:
                beyond += f" to {size_label(facts, flip.last)}"
        condition = SHARED if flip.condition == SHARED else f"{flip.condition} alone"
        direction = "above 0" if flip.direction > 0 else "below 0"
        estimate = "no turn" if flip.estimate is None else size_label(facts, flip.estimate)
        lines.append(line(condition, direction, before, estimate, beyond))
    return Table(
        name="flips",
        title="Smallest error that reverses the ranking",
        corner="Condition",
        columns=("Error", "Ahead without error, up to", "Estimate turns at", "Ahead beyond, from"),
        lines=tuple(lines),
        notes=(
            "Ahead is who significantly is, at all sizes run up to that one, or from that one on, "
            "and neither where no size run is significant. The estimate turns between two of "
            "them, by interpolation. Where nothing is significant with correct inputs there is no "
            "ranking to reverse. All of it holds at once, with the intervals of the map.",
        ),
    )


def map_picture(result: MapResult) -> Svg:
    """Return the map: who is significantly ahead where, the estimate's zero, conditions and
    points."""
    question, facts, side = result.question, result.facts, _SIDE
    title = f"Reversal map of {facts.system}: {question.repair} against {question.baseline}"
    # A relative error is given as a share, and read as percent.
    reach, unit = (100 * facts.up_to, "%") if facts.relative else (facts.up_to, facts.unit)
    ticks = (-reach, -reach / 2, 0.0, reach / 2, reach)
    left = max(_LEFT, *(text_width(tick_label(tick), 11) + 10 for tick in ticks))
    svg = Svg(left + side + _RIGHT, _TOP + side + 48, title, headline(result))
    x = Axis(-facts.up_to, facts.up_to, left, left + side)
    y = Axis(-facts.up_to, facts.up_to, _TOP + side, _TOP)
    hatch = svg.hatch("baseline", "range baseline", 6)
    _key(svg, result, hatch)
    _areas(svg, result, x, y, hatch)
    svg.path(
        f"M{number(x.start)} {number(y.start)}H{number(x.end)}V{number(y.end)}H{number(x.start)}Z",
        "inner",
    )
    first, second = facts.modules
    svg.line((x(0.0), y.start), (x(0.0), y.end), "zero")
    svg.line((x.start, y(0.0)), (x.end, y(0.0)), "zero")
    svg.line((x.start, y.start), (x.end, y.end), "zero")
    for name, at, up, anchor in (
        (first, x.end + 6, y(0.0) - 3, "start"),
        (second, x(0.0), y.end - 20, "middle"),
    ):
        svg.text(at, up, name, "bold", anchor, room=_RIGHT - 8)
        svg.text(at, up + 14, "alone", "bold", anchor)
    svg.text(x.end + 6, y.end + 4, "shared", "bold")
    svg.path(" ".join(_zero(result, x, y)), "range")
    for point in result.points:
        at = x(point.errors[0]), y(point.errors[1])
        svg.circle(at, 2.6, "dot" if point.sign else "dot open", tip=at_point(result, point))
    x, y = Axis(-reach, reach, x.start, x.end), Axis(-reach, reach, y.start, y.end)
    for tick in ticks:
        svg.line((x(tick), y.start), (x(tick), y.start + 4), "axis")
        svg.text(x(tick), y.start + 17, tick_label(tick), "small soft", "middle")
        svg.line((x.start - 4, y(tick)), (x.start, y(tick)), "axis")
        svg.text(x.start - 8, y(tick) + 4, tick_label(tick), "small soft", "end")
    measured = f", {wording.unit(unit)}" if unit not in ("", "1") else ""
    across, upward = (f"error at the {name}{measured}" for name in facts.modules)
    svg.text(x(0.0), y.start + 36, across, "small soft", "middle", room=svg.width)
    svg.text(0, y.end - 38, upward, "small soft", room=svg.width)
    return svg


def _areas(svg: Svg, result: MapResult, x: Axis, y: Axis, hatch: str) -> None:
    """Fill what is significant, a piece around each place of the lattice."""
    sizes, surface = result.surface.sizes, result.surface
    edges = [sizes[0], *((a + b) / 2 for a, b in pairwise(sizes)), sizes[-1]]
    drawn: dict[tuple[int, str], list[str]] = {}
    for row, column in product(range(len(sizes)), repeat=2):
        if sign := surface.sign[row][column]:
            left, right = (number(x(edges[column + i])) for i in (0, 1))
            low, high = (number(y(edges[row + i])) for i in (0, 1))
            opacity = shade(surface.difference[row][column])
            drawn.setdefault((sign, opacity), []).append(f"M{left} {low}H{right}V{high}H{left}Z")
    for (sign, opacity), pieces in sorted(drawn.items()):
        side = "repair-only" if sign > 0 else "baseline-only"
        svg.path("".join(pieces), side, fill_opacity=opacity, shape_rendering="crispEdges")
    marked = [piece for (sign, _), pieces in drawn.items() for piece in pieces if sign < 0]
    if marked:
        svg.path("".join(marked), "", fill=hatch, fill_opacity="0.5", stroke="none")


def _zero(result: MapResult, x: Axis, y: Axis) -> Iterator[str]:
    """Yield a stroke for each cell of the lattice that the estimate's zero crosses."""
    sizes, heights = result.surface.sizes, result.surface.difference
    ends = (sizes[0], sizes[-1])
    for row, column in product(range(len(sizes) - 1), repeat=2):
        around = [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)]
        crossings: list[Point] = []
        for (r1, c1), (r2, c2) in pairwise([*around, around[0]]):
            a, b = heights[r1][c1], heights[r2][c2]
            if (a > 0) != (b > 0):
                share = a / (a - b)
                across = sizes[c1] + share * (sizes[c2] - sizes[c1])
                upward = sizes[r1] + share * (sizes[r2] - sizes[r1])
                crossings.append((across, upward))
        for one, two in zip(crossings[::2], crossings[1::2], strict=True):
            # One along the frame, where the estimate is exactly 0, divides nothing.
            if not any(one[axis] == two[axis] and one[axis] in ends for axis in (0, 1)):
                start, end = (f"{number(x(at))} {number(y(up))}" for at, up in (one, two))
                yield f"M{start}L{end}"


def _key(svg: Svg, result: MapResult, hatch: str) -> None:
    """Draw what is compared, the scale of the differences, and what is not significant."""
    question, cell = result.question, 46.0
    end = 6 * cell
    title = f"Success of {question.repair} minus that of {question.baseline}, pp"
    svg.text(0, 13, title, "head", room=svg.width)
    for name, left, anchor in ((question.baseline, 0.0, "start"), (question.repair, end, "end")):
        svg.text(left, 32, f"{name} ahead", anchor=anchor, room=end / 2 - 6)
    draw_scale(svg, cell, hatch)
    with svg.group("legend"):
        svg.path("M0 74h22v11h-22Z", "inner")
        beside = _entry(svg, 0, 84, "not significant")
        svg.line((beside, 80), (beside + 22, 80), "range")
        _entry(svg, beside, 84, f"estimate {_EQUAL}")
        svg.circle((11, 100), 2.6, "dot")
        beside = _entry(svg, 0, 104, "run, significant")
        svg.circle((beside + 11, 100), 2.6, "dot open")
        _entry(svg, beside, 104, "run, not significant")


def _entry(svg: Svg, left: float, y: float, words: str) -> float:
    """Write what a mark of the key means beside it; return where the next one may begin."""
    svg.text(left + 28, y, words)
    return left + 28 + text_width(words, 12) + 14


def correlation_picture(result: MapResult) -> Svg:
    """Return the expected difference over the correlation, in the colour of the variant ahead."""
    joint, question, facts = result.joint, result.question, result.facts
    description = "; ".join(
        f"{e.correlation:g}: {wording.plain(e.value)} pp" for e in joint.requested
    )
    width = _LEFT + _SIDE + _RIGHT
    svg = Svg(width, 286, f"Expected difference over the correlation, {facts.system}", description)
    x = Axis(-1.0, 1.0, 40, width - 10)
    vertical = covering([end for e in joint.curve for end in (e.low, e.high)], least=10.0)
    y = vertical.at(238, 44)
    title = f"Expected success of {question.repair} minus that of {question.baseline}, pp"
    svg.text(0, 13, title, "head", room=width)
    svg.text(0, 28, _EQUAL, "small soft")
    draw_axes(svg, x, y, 5, (-1.0, -0.5, 0.0, 0.5, 1.0))
    svg.text(x(0.0), 274, "correlation of the two errors", "small soft", "middle")
    draw_band(svg, ((x(e.correlation), y(e.low), y(e.high)) for e in joint.curve))
    sides = {1: "curve repair", -1: "curve baseline", 0: "curve"}
    for one, two in pairwise(joint.curve):
        side = sides[one.sign if one.sign == two.sign else 0]
        svg.line((x(one.correlation), y(one.value)), (x(two.correlation), y(two.value)), side)
    for low, high in joint.undecided:
        svg.line((x(low), y(0)), (x(high), y(0)), "star-range")
    for at in joint.estimates:
        svg.circle((x(at), y(0)), 5, "star", tip=f"estimate: no difference at {at:.2f}")
    return svg


def page(result: MapResult, provenance: RunProvenance) -> str:
    """Return the map as one page that opens without a network."""
    *flips, conditions = ({"table": t, "markup": html(t)} for t in tables(result))
    return render(
        "map.html.j2",
        result=result,
        question=result.question,
        facts=result.facts,
        provenance=provenance,
        words=words(result),
        up_to=size_label(result.facts, result.facts.up_to),
        map=map_picture(result).render(),
        curve=correlation_picture(result).render(),
        flips=flips[0] if flips else None,
        conditions=conditions,
        estimand=scenes_like_these(result.facts),
    )


def write_map(result: MapResult, provenance: RunProvenance, folder: Path) -> list[Path]:
    """Write `report.html`, `map.svg`, `correlation.svg` and `table.md`; return their paths."""
    pages = {
        "report.html": page(result, provenance),
        "map.svg": map_picture(result).render(standalone=True) + "\n",
        "correlation.svg": correlation_picture(result).render(standalone=True) + "\n",
        "table.md": markdown_blocks(tables(result)) + "\n",
    }
    return write_pages(pages, folder)
