"""A map as tables, pictures, terminal and page; all numbers are the record's."""

from pathlib import Path

from markupsafe import Markup

from faultpath.analyses.map.lattice import SHARED
from faultpath.analyses.map.record import MapRecord
from faultpath.analyses.sentences import wording
from faultpath.analyses.sentences.maps import estimand
from faultpath.analyses.tables import Entry, Line, Table, line
from faultpath.analyses.tables.html import html
from faultpath.analyses.tables.markdown import block
from faultpath.report.frame import render, write_pages
from faultpath.report.map_pictures import correlation_picture, map_picture
from faultpath.run.provenance import RunProvenance
from faultpath.stats.power import MIN_SCENES


def tables(record: MapRecord) -> tuple[Table, ...]:
    """Return how large an error reverses the ranking, and the differences at one or equal errors.

    With too few scenes for a significant difference there is no ranking that could reverse.
    """
    flips = (_flips(record),) if record.scenes >= MIN_SCENES else ()
    return *flips, _conditions(record)


def _conditions(record: MapRecord) -> Table:
    question, facts = record.question, record.facts
    of = {point.errors: point for point in record.points}
    lines: list[Line] = []
    for size in sorted({x or y for x, y in of if x == y or not x or not y}):
        entries: list[Entry] = []
        for errors in ((size, 0.0), (0.0, size), (size, size)):
            entry = Entry(text="not run")
            if point := of.get(errors):
                ends = f"[{wording.plain(point.low)}, {wording.plain(point.high)}]"
                text = f"{wording.signed(point.difference)} {ends}"
                entry = Entry(text=text, detected=point.sign != 0)
            entries.append(entry)
        lines.append(line(facts.size_label(size), *entries))
    return Table(
        name="conditions",
        title=f"{question.repair} minus {question.baseline}, success, pp",
        corner="Error",
        columns=(*(f"{name} alone" for name in facts.modules), "shared"),
        lines=tuple(lines),
        notes=(
            f"{wording.counted(record.scenes, 'scene')} of {facts.library}, "
            f"{wording.seeds(question.seeds)}. Intervals hold at all {len(record.points)} pairs of "
            "errors at once. Significant: the interval leaves out 0, and a sign test agrees.",
        ),
    )


def _flips(record: MapRecord) -> Table:
    question, facts = record.question, record.facts
    ahead = {1: question.repair, -1: question.baseline}
    lines: list[Line] = []
    for flip in record.flips:
        kept = turned = "neither"
        if flip.start and flip.until is not None:
            kept = f"{ahead[flip.start]}, {facts.size_label(flip.until)}"
        if flip.turned and flip.first is not None and flip.last is not None:
            turned = f"{ahead[flip.turned]}, {facts.size_label(flip.first)}"
            if abs(flip.last) < facts.up_to:
                turned += f" to {facts.size_label(flip.last)}"
        condition = SHARED if flip.condition == SHARED else f"{flip.condition} alone"
        direction = "above 0" if flip.direction > 0 else "below 0"
        estimate = "no turn" if flip.estimate is None else facts.size_label(flip.estimate)
        lines.append(line(condition, direction, kept, estimate, turned))
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


def page(record: MapRecord, provenance: RunProvenance) -> str:
    """Return the map as one page that opens without a network."""
    *turns, conditions = tables(record)
    return render(
        "map.html.j2",
        record=record,
        question=record.question,
        facts=record.facts,
        provenance=provenance,
        sentences=record.sentences,
        headline=record.headline,
        map=Markup(map_picture(record).render()),
        curve=Markup(correlation_picture(record).render()),
        flips=Markup(html(turns[0])) if turns else "",
        flips_notes=turns[0].notes if turns else (),
        conditions=Markup(html(conditions)),
        estimand=estimand(record.facts),
        conditions_notes=conditions.notes,
    )


def write_map(record: MapRecord, provenance: RunProvenance, folder: Path) -> list[Path]:
    """Write `report.html`, `map.svg`, `correlation.svg` and `table.md`; return their paths."""
    pages = {
        "report.html": page(record, provenance),
        "map.svg": map_picture(record).render(standalone=True) + "\n",
        "correlation.svg": correlation_picture(record).render(standalone=True) + "\n",
        "table.md": table_markdown(record),
    }
    return write_pages(pages, folder)


def table_markdown(record: MapRecord) -> str:
    """Return all tables as Markdown."""
    return "\n\n".join(map(block, tables(record))) + "\n"
