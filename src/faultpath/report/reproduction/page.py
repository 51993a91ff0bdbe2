"""A reproduction as one page that opens without a network."""

from collections.abc import Mapping
from dataclasses import dataclass

import pyarrow as pa
from markupsafe import Markup

from faultpath.record import DecisionRecord
from faultpath.report import figures, wording
from faultpath.report.figures.gallery import scene_view
from faultpath.report.figures.sweep import sweep_plot
from faultpath.report.frame import render
from faultpath.report.inputs import Traces
from faultpath.report.interface_drawing import draw_interface
from faultpath.report.interface_wiring import StruckPath, struck_paths
from faultpath.report.pairing import read_pairs
from faultpath.report.reproduction import words
from faultpath.report.reproduction.inputs import ReproductionInput
from faultpath.report.reproduction.ledger import ledger_rows
from faultpath.report.viewer import ViewerData, choose, viewer_data
from faultpath.store import read_table
from faultpath.store.tables import encode_outcomes
from faultpath.tables.html import html
from faultpath.trials import FloorPlan, OutcomeTable

_STYLES = ("tokens.css", "svg.css", "page.css", "viewer.css", "reproduction.css")
_SCRIPTS = ("page.js", "plan.js", "scene3d.js", "viewer.js", "reproduction.js")


@dataclass(frozen=True)
class _Audit:
    """The audit in detail, as the viewer takes it."""

    record: DecisionRecord
    traces: Traces
    plans: Mapping[str, FloorPlan]


def reproduction_page(source: ReproductionInput) -> str:
    """Return the whole page as HTML: styles, scripts, pictures and data inside."""
    reproduction, decision = source.reproduction, source.decision
    struck = struck_paths(decision) if decision else ()
    return render(
        "reproduction.html.j2",
        _STYLES,
        _SCRIPTS,
        found=reproduction,
        ledger=reproduction.ledger,
        rows=ledger_rows(reproduction.ledger),
        tables=[
            (table, Markup(html(table, "beside", caption=False))) for table in reproduction.tables
        ],
        sweeps=_sweeps(source),
        gallery=_gallery(source),
        reversal=_reversal(source, struck),
        struck=struck,
        asked=decision and decision.question,
        paths={path.name: path.title for path in decision.paths} if decision else {},
        viewer=_flights(source),
        provenance=source.provenance,
        w=wording,
        words=words,
    )


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


def _reversal(source: ReproductionInput, struck: tuple[StruckPath, ...]) -> Mapping[str, object]:
    drawing = Markup(draw_interface(source.interface, struck, source.variants, standalone=False))
    if source.decision is None:
        return {"interface": drawing, "forest": None}
    rows, asked = figures.effect_rows(source.decision), source.decision.question
    return {
        "interface": drawing,
        "forest": Markup(figures.forest(rows, asked.baseline, asked.repair)),
        "forest_narrow": Markup(figures.forest(rows, asked.baseline, asked.repair, narrow=True)),
    }


def _flights(source: ReproductionInput) -> ViewerData | None:
    if source.decision is None:
        return None
    audit = _Audit(source.decision, source.traces, source.plans)
    chosen = choose(audit, read_pairs(_trials(source.outcomes, audit.record), audit.record))
    return viewer_data(audit, chosen) if chosen else None


def _trials(outcomes: OutcomeTable, decision: DecisionRecord) -> pa.Table:
    asked, paths = decision.question, {path.name for path in decision.paths}
    arms = (asked.baseline, asked.repair)
    rows = (row for row in outcomes.rows if row.variant in arms and row.path in paths)
    return read_table(encode_outcomes(OutcomeTable(tuple(rows))))
