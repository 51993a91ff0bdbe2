"""A reproduction as one page that opens without a network."""

from collections import Counter
from collections.abc import Mapping

from markupsafe import Markup

from faultpath.record import wording
from faultpath.record.reproduction import ClaimVerdict, Reproduction
from faultpath.report.effects import forest
from faultpath.report.figures.gallery import scene_view
from faultpath.report.figures.sweep import sweep_plot
from faultpath.report.frame import render
from faultpath.report.pairing import read_pairs
from faultpath.report.reproduction import words
from faultpath.report.reproduction.glossary import GLOSSARY
from faultpath.report.reproduction.inputs import ReproductionInput
from faultpath.report.reproduction.ledger import ledger_plots
from faultpath.report.viewer import SCRIPTS as VIEWER_SCRIPTS
from faultpath.report.viewer import Viewer, viewer_data
from faultpath.tables.html import html

_STYLES = ("tokens.css", "svg.css", "page.css", "viewer.css", "reproduction.css")
_SCRIPTS = ("page.js", *VIEWER_SCRIPTS, "reproduction.js")


def reproduction_page(source: ReproductionInput) -> str:
    """Return the whole page as HTML: styles, scripts, pictures and data inside."""
    reproduction, decision = source.reproduction, source.decision
    return render(
        "reproduction.html.j2",
        _STYLES,
        _SCRIPTS,
        found=reproduction,
        ledger=reproduction.ledger,
        central=source.central
        and {
            "state": source.central[0],
            "table": Markup(html(source.central[1])),
            "notes": (*source.central[1].legend(), *source.central[1].notes),
        },
        beside=source.beside,
        plots=ledger_plots(reproduction.ledger, source.limits, source.beside),
        topics=_topics(source),
        sizes=Counter(map(words.state, reproduction.ledger.claims)),
        glossary=GLOSSARY,
        tables=[
            (table, Markup(html(table, "beside", caption=False))) for table in reproduction.tables
        ],
        footnotes=_footnotes(reproduction),
        sweeps=_sweeps(source),
        gallery=_gallery(source),
        forest=Markup(forest(decision)) if decision else "",
        asked=decision and decision.question,
        paths={path.name: path.title for path in decision.paths} if decision else {},
        viewer=_flights(source),
        provenance=source.provenance,
        w=wording,
        words=words,
    )


def _topics(source: ReproductionInput) -> list[tuple[str, list[ClaimVerdict]]]:
    claims = source.reproduction.ledger.claims
    named = [
        (title, [claim for claim in claims if claim.id in ids])
        for title, ids in source.topics.items()
    ]
    known = {id for ids in source.topics.values() for id in ids}
    rest = [claim for claim in claims if claim.id not in known]
    return [group for group in (*named, ("Other" if known else "", rest)) if group[1]]


def _footnotes(found: Reproduction) -> dict[str, int]:
    every = [note for part in (*found.tables, *found.figures) for note in dict.fromkeys(part.notes)]
    several = [note for note in dict.fromkeys(every) if every.count(note) > 1]
    return {note: number for number, note in enumerate(several, 1)}


def _sweeps(source: ReproductionInput) -> list[Mapping[str, object]]:
    return [
        {
            "sweep": sweep,
            "wide": Markup(sweep_plot(sweep)),
            "narrow": Markup(sweep_plot(sweep, narrow=True)),
        }
        for sweep in source.reproduction.figures
    ]


def _gallery(source: ReproductionInput) -> list[Markup]:
    return [
        Markup(scene_view(source.plans[shown.scene], shown.topology))
        for shown in source.reproduction.gallery
        if shown.scene in source.plans
    ]


def _flights(source: ReproductionInput) -> Viewer | None:
    record = source.decision
    if record is None or not source.traces.positions:
        return None
    pairs = read_pairs(source.outcomes, record)
    return viewer_data(record, source.traces, source.plans, pairs)
