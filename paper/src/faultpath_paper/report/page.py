"""A reproduction as one page that opens without a network."""

from collections.abc import Sequence

from markupsafe import Markup

from faultpath.report.frame import render
from faultpath.report.sentences import wording
from faultpath.report.svg import Axis, Svg, draw_axes, draw_band, text_width, tick_label
from faultpath.report.tables import Table, html
from faultpath.run.provenance import RunProvenance
from faultpath_paper.answers import Point, Reproduction, Series, Sweep
from faultpath_paper.central import QUESTION
from faultpath_paper.report import words

LOOKS = 4
"""Looks that lines take in turn: colour, dashes and mark differ together."""
_KEY_ROW, _SAMPLE = 20.0, 28.0


def sweep_plot(sweep: Sweep) -> Markup:
    """Return the lines of a sweep with their bands."""
    width, height = 560.0, 250.0
    top = _KEY_ROW + 34
    lines = (f"{line.label}: {', '.join(map(_point, line.points))}" for line in sweep.series)
    svg = Svg(width, top + height + 42, sweep.title, "; ".join(lines))
    _key(svg, sweep.series)
    across, upward = _axes([point for line in sweep.series for point in line.points])
    x, y = across.at(34, width - 10), upward.at(top + height, top)
    svg.text(0, top - 12, sweep.y_title, "small soft")
    draw_axes(svg, x, y, 6, x.ticks(6), zero="axis")
    if x.start < x(0.0) < x.end:
        svg.line((x(0.0), y.start), (x(0.0), y.end), "axis")
    svg.text((x.start + x.end) / 2, top + height + 36, sweep.x_title, "small soft", "middle")
    for i, line in enumerate(sweep.series):
        _band(svg, line, x, y, f"spread s{i % LOOKS}")
    for i, line in enumerate(sweep.series):
        svg.polyline([(x(p.x), y(p.y)) for p in line.points], f"curve s{i % LOOKS}")
        for point in line.points:
            _mark(svg, x(point.x), y(point.y), i % LOOKS, f"{line.label}, {_point(point)}")
    return svg.render()


def _point(point: Point) -> str:
    shown = f"{wording.plain(point.y)} {wording.interval(point)}".rstrip()
    return f"{tick_label(point.x)}: {shown}"


def _axes(points: Sequence[Point]) -> tuple[Axis, Axis]:
    across = [point.x for point in points] or [0.0, 1.0]
    upward = [0.0, *(v for p in points for v in (p.y, p.low, p.high) if v is not None)]
    (left, right), (low, high) = ((min(ends), max(ends)) for ends in (across, upward))
    pad = 0.03 * (right - left) or 0.5
    x = Axis(left - pad, right + pad, 0.0, 1.0)
    return x, Axis(low, high + (0.04 * (high - low) or 1.0), 0.0, 1.0)


def _band(svg: Svg, line: Series, x: Axis, y: Axis, look: str) -> None:
    ends = [(p.x, p.low, p.high) for p in line.points if p.low is not None and p.high is not None]
    if len(ends) > 1:
        draw_band(svg, ((x(at), y(low), y(high)) for at, low, high in ends), look)


def _mark(svg: Svg, x: float, y: float, look: int, tip: str) -> None:
    cls = f"spot s{look}"
    match look:
        case 0:
            svg.circle((x, y), 3.6, cls, tip)
        case 1:
            svg.rect(x - 3.4, y - 3.4, 6.8, 6.8, cls, tip=tip)
        case 2:
            svg.polygon([(x - 4.4, y + 3.4), (x + 4.4, y + 3.4), (x, y - 4.6)], cls, tip)
        case _:
            svg.polygon([(x - 4.8, y), (x, y - 4.8), (x + 4.8, y), (x, y + 4.8)], cls, tip)


def _key(svg: Svg, series: Sequence[Series]) -> None:
    left, y = 0.0, 9.0
    for i, line in enumerate(series):
        svg.line((left, y), (left + _SAMPLE, y), f"curve s{i % LOOKS}")
        _mark(svg, left + _SAMPLE / 2, y, i % LOOKS, line.label)
        svg.text(left + _SAMPLE + 8, y + 4, line.label)
        left += _SAMPLE + 8 + text_width(line.label, 12) + 22


def reproduction_page(
    record: Reproduction, provenance: RunProvenance | None, central: tuple[str, str, Table] | None
) -> str:
    """Return the whole page as HTML: styles and pictures inside.

    `central` is our answer to the paper's central question with its table; `None` where the run
    is not about it.
    """
    exhibits = (*record.tables, *record.figures)
    notes = [note for part in exhibits for note in dict.fromkeys(part.notes)]
    shared = [note for note in dict.fromkeys(notes) if notes.count(note) > 1]
    return render(
        "reproduction.html.j2",
        ("tokens.css", "svg.css", "page.css", "reproduction.css"),
        (),
        "faultpath_paper.report",
        record=record,
        ledger=record.ledger,
        central=central
        and {
            "answer": central[0],
            "question": QUESTION,
            "detail": central[1],
            "table": html(central[2]),
            "notes": (*central[2].legend(), *central[2].notes),
        },
        tables=[(table, html(table, "beside", caption=False)) for table in record.tables],
        footnotes={note: number for number, note in enumerate(shared, 1)},
        sweeps=[{"sweep": sweep, "picture": sweep_plot(sweep)} for sweep in record.figures],
        provenance=provenance,
        w=wording,
        words=words,
    )
