"""A search as table, picture, terminal and page; all numbers are the record's."""

from pathlib import Path

from markupsafe import Markup

from faultpath.decisions.search.model import SearchRecord
from faultpath.decisions.sentences import wording
from faultpath.decisions.tables import Table, line
from faultpath.decisions.tables.html import html
from faultpath.decisions.tables.markdown import block
from faultpath.report.effects import effect_axis, effect_rows
from faultpath.report.frame import render, write_pages
from faultpath.report.svg import Axis, Svg, tick_label
from faultpath.report.tables import DIFFERENCE, by_path
from faultpath.trials.provenance import RunProvenance

_ROWS = 8
"""Number of the faults tried that a table shows."""
_EFFECTS = ("baseline", "repair", *DIFFERENCE, "holm", "scenes")


def tables(record: SearchRecord) -> tuple[Table, ...]:
    """Return the faults tried that looked worst, and the effects of the one that was audited."""
    question, many = record.question, len(record.tried)
    worst = sorted(record.tried, key=lambda tried: -tried.regret_pp)[:_ROWS]
    tried = Table(
        name="tried",
        title=f"Tried, {question.repair} minus {question.baseline}, success, pp: no evidence",
        corner="Fault",
        columns=(f"{question.bounds.isolated} alone", "shared", "regret"),
        lines=tuple(
            line(
                tried.fault,
                *map(wording.signed, (tried.isolated_pp, tried.shared_pp)),
                wording.plain(tried.regret_pp),
                aside="chosen" if tried.fault == record.best else "",
            )
            for tried in worst
        ),
        notes=(
            f"{len(worst)} of {many} faults, in the {question.finding} scenes that find. Regret is "
            "what the choice by the isolated fault loses under the shared one, as far as it would "
            "be made. The best of many looks better than it is: only the confirming audit is a "
            "test.",
        ),
    )
    if record.confirmed is None:
        return (tried,)
    return by_path(record.confirmed, _EFFECTS, "Confirming audit; bold is significant"), tried


def picture(record: SearchRecord) -> Svg:
    """Return the faults tried: the difference with the isolated module alone across, that with the
    fault shared upward. In the shaded corners the two disagree."""
    question, side, left, top = record.question, 320.0, 46.0, 46.0
    svg = Svg(
        left + side + 20, top + side + 48, "Faults tried in the scenes that find", "No evidence."
    )
    svg.text(0, 13, "Faults tried in the scenes that find: no evidence", "head", room=svg.width)
    svg.text(0, 32, "fault shared, pp", "small soft")
    x, y = Axis(-100.0, 100.0, left, left + side), Axis(-100.0, 100.0, top + side, top)
    for across, up in ((-100.0, 100.0), (0.0, 0.0)):
        svg.rect(x(across), y(up), side / 2, side / 2, "band")
    for tick in (-100.0, -50.0, 0.0, 50.0, 100.0):
        cls = "axis" if tick else "zero"
        svg.line((x(tick), y.start), (x(tick), y.end), cls)
        svg.line((x.start, y(tick)), (x.end, y(tick)), cls)
        svg.text(x(tick), y.start + 16, tick_label(tick), "small soft", "middle")
        svg.text(x.start - 8, y(tick) + 4, tick_label(tick), "small soft", "end")
    difference = f"{question.repair} minus {question.baseline}, pp"
    below = f"the fault at the {question.bounds.isolated} alone, {difference}"
    svg.text(x(0.0), y.start + 36, below, "small soft", "middle", room=svg.width)
    for tried in record.tried:
        at, chosen = (x(tried.isolated_pp), y(tried.shared_pp)), tried.fault == record.best
        values = ", ".join(map(wording.signed, (tried.isolated_pp, tried.shared_pp)))
        tip = f"{tried.fault}: {values} pp{', chosen' if chosen else ''}"
        if chosen:
            svg.circle(at, 8.0, "star", tip=tip)
        svg.circle(at, 3.5, "dot open", tip=tip)
    return svg


def write_search(record: SearchRecord, provenance: RunProvenance, folder: Path) -> list[Path]:
    """Write `report.html`, `tried.svg` and `table.md`; return their paths."""
    *effects, tried = tables(record)
    page = render(
        "search.html.j2",
        record=record,
        asked=record.question,
        provenance=provenance,
        picture=Markup(picture(record).render()),
        tried=Markup(html(tried)),
        notes=tried.notes,
        effects=effect_rows(record.confirmed) if record.confirmed else [],
        axis=effect_axis(record.confirmed) if record.confirmed else "",
        numbers=Markup(html(effects[0])) if effects else "",
    )
    pages = {
        "report.html": page,
        "tried.svg": picture(record).render(standalone=True) + "\n",
        "table.md": "\n\n".join(map(block, tables(record))) + "\n",
    }
    return write_pages(pages, folder)
