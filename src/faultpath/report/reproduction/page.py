"""A reproduction as one page that opens without a network."""

from collections.abc import Mapping

from markupsafe import Markup

from faultpath.report import wording
from faultpath.report.figures.effects import effect_rows, forest
from faultpath.report.figures.gallery import scene_view
from faultpath.report.figures.sweep import sweep_plot
from faultpath.report.frame import render
from faultpath.report.interface_drawing import draw_interface
from faultpath.report.interface_wiring import StruckPath, struck_paths
from faultpath.report.pairing import read_pairs
from faultpath.report.reproduction import words
from faultpath.report.reproduction.inputs import ReproductionInput
from faultpath.report.reproduction.ledger import ledger_plots
from faultpath.report.viewer import viewer_data
from faultpath.tables.html import html

_STYLES = ("tokens.css", "svg.css", "page.css", "viewer.css", "reproduction.css")
_SCRIPTS = ("page.js", "plan.js", "scene3d.js", "viewer.js", "reproduction.js")


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
        beside=source.beside,
        plots=ledger_plots(reproduction.ledger),
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
    rows, asked = effect_rows(source.decision), source.decision.question
    return {
        "interface": drawing,
        "forest": Markup(forest(rows, asked.baseline, asked.repair)),
        "forest_narrow": Markup(forest(rows, asked.baseline, asked.repair, narrow=True)),
    }


def _flights(source: ReproductionInput) -> Mapping[str, object] | None:
    record = source.decision
    if record is None:
        return None
    pairs = read_pairs(source.outcomes, record)
    return viewer_data(record, source.traces, source.plans, pairs)
