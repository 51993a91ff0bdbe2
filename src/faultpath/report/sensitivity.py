"""A sensitivity analysis as table, picture, terminal and page; all numbers are the record's."""

from pathlib import Path

from markupsafe import Markup

from faultpath.decisions.sensitivity.model import Index, SensitivityRecord, Uncertain
from faultpath.decisions.sentences import wording
from faultpath.decisions.tables import MISSING, Entry, Table, line
from faultpath.decisions.tables.csv import csv_text
from faultpath.decisions.tables.html import html
from faultpath.decisions.tables.markdown import block
from faultpath.report.frame import render, write_pages
from faultpath.report.svg import Svg, covering, tick_label
from faultpath.trials.provenance import RunProvenance

_PITCH, _TOP, _LEFT, _WIDTH = 34.0, 40.0, 150.0, 560.0


def table(record: SensitivityRecord) -> Table:
    """Return both indices of each group, percent of the variance; bold intervals leave out 0."""
    question = record.question
    of = {index.group: index for index in record.indices}
    return Table(
        name="sensitivity",
        title=f"Share of the variance of {question.said}, %; bold leaves out 0",
        corner="Source",
        columns=("Error", "Alone (first-order)", "With others (total)"),
        words=("Error",),
        lines=tuple(
            line(
                group.name,
                error(group),
                *(
                    map(_entry, (of[group.name].first, of[group.name].total))
                    if group.name in of
                    else (MISSING, MISSING)
                ),
            )
            for group in question.groups
        ),
        notes=(
            f"{wording.counted(record.scenes, 'scene')} of {question.library}, "
            f"{wording.seeds(question.seeds)}, {question.points} points. Alone: what would go on "
            "average if the source were known exactly. With others: what would stay if all others "
            "were. Estimates may lie outside 0 to 100.",
        ),
    )


def error(group: Uncertain) -> str:
    """Return how large the errors of a group are, each size once."""
    errors: dict[str, None] = {}
    for part in group.parts:
        half = part.error.half_range
        size = part.error.expected_std if half is None else half
        shown = f"{100 * size:.4g} %" if part.error.relative else f"{size:.4g}"
        errors[f"±{shown}" if half is not None else f"std {shown}"] = None
    return ", ".join(errors)


def _entry(index: Index) -> Entry:
    value, low, high = (wording.plain(100 * v) for v in (index.value, index.low, index.high))
    return Entry(text=f"{value} [{low}, {high}]", detected=index.counts)


def picture(record: SensitivityRecord) -> Svg:
    """Return the indices with their intervals, a row a group: alone above, with others below."""
    rows = record.indices
    bottom = _TOP + _PITCH * len(rows)
    svg = Svg(_WIDTH, bottom + 40, "Share of the variance by source", record.headline)
    svg.text(0, 13, f"Share of the variance of {record.question.said}", "head", room=_WIDTH)
    ends = [100 * v for e in rows for i in (e.first, e.total) for v in (i.low, i.high)]
    x = covering(ends, least=100.0).at(_LEFT, _WIDTH - 8)
    for tick in x.ticks(6):
        svg.line((x(tick), _TOP - 8), (x(tick), bottom), "zero" if tick == 0 else "axis")
        svg.text(x(tick), bottom + 16, tick_label(tick), "small soft", "middle")
    svg.text(x(50.0), bottom + 34, "filled: alone; open: with others, %", "small soft", "middle")
    for row, share in enumerate(rows):
        y = _TOP + _PITCH * row
        svg.text(0, y + 14, share.group, "bold" if share.first.counts else "", room=_LEFT - 10)
        for index, at, dot in ((share.first, y + 5, "dot"), (share.total, y + 17, "dot open")):
            svg.line((x(100 * index.low), at), (x(100 * index.high), at), "range")
            svg.circle((x(100 * index.value), at), 4.0, dot, _entry(index).text)
    return svg


def write_sensitivity(
    record: SensitivityRecord, provenance: RunProvenance, folder: Path
) -> list[Path]:
    """Write `report.html`, `sensitivity.svg`, `sensitivity.csv` and `table.md`; return their
    paths."""
    shares = table(record)
    page = render(
        "sensitivity.html.j2",
        record=record,
        asked=record.question,
        provenance=provenance,
        picture=Markup(picture(record).render()) if record.indices else "",
        table=Markup(html(shares)),
        notes=shares.notes,
    )
    files = {
        "report.html": page,
        "sensitivity.svg": picture(record).render(standalone=True) + "\n",
        "sensitivity.csv": csv_text(shares),
        "table.md": block(shares) + "\n",
    }
    return write_pages(files, folder)
