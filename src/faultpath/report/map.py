"""A map as tables, pictures, terminal and page; all numbers are the record's."""

from pathlib import Path

from markupsafe import Markup

from faultpath.analyses.map.model import MapResult
from faultpath.analyses.model import SHARED
from faultpath.core.text import counted
from faultpath.report.frame import render, write_pages
from faultpath.report.map_pictures import correlation_picture, map_picture
from faultpath.report.sentences import wording
from faultpath.report.sentences.maps import size_label
from faultpath.report.sentences.phrases import scenes_like_these
from faultpath.report.sentences.words import words
from faultpath.report.tables import Entry, Line, Table, line
from faultpath.report.tables.html import html
from faultpath.report.tables.markdown import blocks
from faultpath.run.provenance import RunProvenance
from faultpath.stats.power import MIN_SCENES


def tables(record: MapResult) -> tuple[Table, ...]:
    """Return how large an error reverses the ranking, and the differences at one or equal errors.

    With too few scenes for a significant difference there is no ranking that could reverse.
    """
    flips = (_flips(record),) if record.scenes >= MIN_SCENES else ()
    return *flips, _conditions(record)


def _conditions(record: MapResult) -> Table:
    question, facts = record.question, record.facts
    of = {point.errors: point for point in record.points}
    lines: list[Line] = []
    for size in sorted({x or y for x, y in of if x == y or not x or not y}):
        entries: list[Entry] = []
        for errors in ((size, 0.0), (0.0, size), (size, size)):
            entry = Entry(text="not run")
            if point := of.get(errors):
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
            f"{counted(record.scenes, 'scene')} of {facts.library}, "
            f"{wording.seeds(question.seeds)}. Intervals hold at all {len(record.points)} pairs of "
            "errors at once. Significant: the interval leaves out 0, and a sign test agrees.",
        ),
    )


def _flips(record: MapResult) -> Table:
    facts = record.facts
    lines: list[Line] = []
    for flip in record.flips:
        kept = turned = "neither"
        if flip.start and flip.until is not None:
            kept = f"{record.winner(flip.start)}, {size_label(facts, flip.until)}"
        if flip.turned and flip.first is not None and flip.last is not None:
            turned = f"{record.winner(flip.turned)}, {size_label(facts, flip.first)}"
            if abs(flip.last) < facts.up_to:
                turned += f" to {size_label(facts, flip.last)}"
        condition = SHARED if flip.condition == SHARED else f"{flip.condition} alone"
        direction = "above 0" if flip.direction > 0 else "below 0"
        estimate = "no turn" if flip.estimate is None else size_label(facts, flip.estimate)
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


def page(record: MapResult, provenance: RunProvenance) -> str:
    """Return the map as one page that opens without a network."""
    *turns, conditions = tables(record)
    return render(
        "map.html.j2",
        record=record,
        question=record.question,
        facts=record.facts,
        provenance=provenance,
        words=words(record),
        up_to=size_label(record.facts, record.facts.up_to),
        map=Markup(map_picture(record).render()),
        curve=Markup(correlation_picture(record).render()),
        flips=Markup(html(turns[0])) if turns else "",
        flips_notes=turns[0].notes if turns else (),
        conditions=Markup(html(conditions)),
        estimand=scenes_like_these(record.facts),
        conditions_notes=conditions.notes,
    )


def write_map(record: MapResult, provenance: RunProvenance, folder: Path) -> list[Path]:
    """Write `report.html`, `map.svg`, `correlation.svg` and `table.md`; return their paths."""
    pages = {
        "report.html": page(record, provenance),
        "map.svg": map_picture(record).render(standalone=True) + "\n",
        "correlation.svg": correlation_picture(record).render(standalone=True) + "\n",
        "table.md": blocks(tables(record)) + "\n",
    }
    return write_pages(pages, folder)
