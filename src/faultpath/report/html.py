"""The report as one page that opens without a network, as a notebook's cell, and as files."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from markupsafe import Markup

from faultpath.record import wording
from faultpath.record.model import Cell, DecisionRecord, Effect
from faultpath.record.plain import about, decided_words, plain_words
from faultpath.report import story
from faultpath.report.adding import adding
from faultpath.report.figures.adding import adding_panels, line_key
from faultpath.report.figures.effects import effect_rows, forest, secondary_panel
from faultpath.report.figures.fork import fork_panels
from faultpath.report.figures.frequency import frequency_panel, shared_range
from faultpath.report.figures.outcomes import outcome_bars
from faultpath.report.figures.pairs import pair_grid, pair_key
from faultpath.report.frame import fragment, render
from faultpath.report.inputs import ReportInput
from faultpath.report.interface_drawing import draw_interface
from faultpath.report.interface_parts import ChannelRows, concerned, tap_rows
from faultpath.report.interface_wiring import Wiring, struck_paths
from faultpath.report.pairing import Kind, Pair, read_pairs
from faultpath.report.shares import shares
from faultpath.report.svg import template
from faultpath.report.tables import BEHIND, SHOWN, by_path, latex_table, markdown_table
from faultpath.report.thresholds import by_threshold
from faultpath.report.viewer import SCRIPTS as VIEWER_SCRIPTS
from faultpath.report.viewer import Viewer, viewer_data
from faultpath.store import make_folder, write_text
from faultpath.tables.html import html
from faultpath.trials.metrics import VEHICLE

_STYLES = ("tokens.css", "svg.css", "page.css", "viewer.css")
_SCRIPTS = ("page.js", "shares.js", *VIEWER_SCRIPTS)


def report_page(source: ReportInput) -> str:
    """Return the whole report as HTML: styles, scripts, pictures and data inside."""
    pairs = read_pairs(source.outcomes, source.record)
    viewer = viewer_data(source.record, source.traces, source.plans, pairs, source.signals)
    return render(
        "report.html.j2",
        _STYLES,
        _SCRIPTS,
        record=source.record,
        asked=source.record.question,
        provenance=source.provenance,
        paths=_path_titles(source.record),
        story=_story(source, pairs),
        tiles=_tiles(source.record),
        pictures=_pictures(source, pairs, viewer),
        struck=struck_paths(source.record),
        void=[pair for pair in pairs if pair.kind is Kind.VOID],
        n_void=sum(pair.kind is Kind.VOID for pair in pairs),
        n_pairs=len(pairs),
        n_trials=len(source.outcomes.rows),
        n_left_out=sum(pair.kind is Kind.LEFT_OUT for pair in pairs),
        effects=Markup(html(by_path(source.record, BEHIND, "What stands behind each effect"))),
        viewer=viewer,
        w=wording,
    )


def notebook_view(record: DecisionRecord) -> str:
    """Return HTML for one cell's output; its colours and rules stay within it."""
    asked = record.question
    styles = template("tokens.css").replace(":root", ".faultpath") + template("svg.css")
    return fragment(
        "notebook.html.j2",
        styles=Markup(styles + template("notebook.css")),
        record=record,
        table=Markup(html(by_path(record, SHOWN), caption=False)),
        forest=Markup(forest(effect_rows(record), asked.baseline, asked.repair)),
        w=wording,
    )


def write_report(source: ReportInput, folder: Path) -> list[Path]:
    """Write `report.html`, `table.tex` and `table.md` into `folder` and return their paths.

    Each file appears whole or not at all. Raises `UserError` where the folder cannot be written.
    """
    makers: dict[str, Callable[[], str]] = {
        "report.html": lambda: report_page(source),
        "table.tex": lambda: latex_table(source.record),
        "table.md": lambda: markdown_table(source.record),
    }
    make_folder(folder)
    for name, make in makers.items():
        write_text(folder / name, make(), folder)
    return [folder / name for name in makers]


def _story(source: ReportInput, pairs: Sequence[Pair]) -> Mapping[str, object]:
    why = adding(source, pairs)
    return {
        "adding": why
        and {
            "words": why.words,
            "caption": why.caption,
            "cut": why.cut,
            "key": [(Markup(sample), name) for sample, name in line_key(why)],
            "panels": list(map(Markup, adding_panels(why))),
        },
        "fault": story.fault_story(source),
        "variants": list(zip(("baseline", "repair"), source.variants, strict=True)),
        "meaning": story.isolation_words(source),
        "out_of_reach": story.out_of_reach(source),
        "panels": [Markup(panel) for panel in fork_panels(story.forks(source))],
        "plain": plain_words(source.record),
    }


def _path_titles(record: DecisionRecord) -> dict[str, str]:
    return {path.name: path.title for path in record.paths}


def _cells(record: DecisionRecord, path: str) -> list[Cell]:
    wanted = (record.question.baseline, record.question.repair)
    cells = [cell for cell in record.cells if cell.path == path and cell.variant in wanted]
    return sorted(cells, key=lambda cell: wanted.index(cell.variant))


def _tiles(record: DecisionRecord) -> list[tuple[str, str, Effect | None, str]]:
    known, effects = about(record), {effect.path: effect for effect in record.effects}
    return [
        (name, title, effects.get(name), decided_words(known, effects.get(name)))
        for name, title in _path_titles(record).items()
    ]


def _pictures(
    source: ReportInput, pairs: Sequence[Pair], viewer: Viewer | None
) -> Mapping[str, object]:
    record, shown = source.record, viewer.shown if viewer else frozenset[tuple[str, int]]()
    titles, asked = _path_titles(record), record.question
    rows = effect_rows(record)
    axis = shared_range(record.break_even)
    return {
        "interface": _interface(source),
        "forest": Markup(forest(rows, asked.baseline, asked.repair)),
        "forest_narrow": Markup(forest(rows, asked.baseline, asked.repair, narrow=True)),
        "frequency": [
            Markup(frequency_panel(b, titles.get(b.path, b.path), axis))
            for b in record.break_even
            if b.curve
        ],
        "shares": shares(record),
        "pairs": [
            Markup(pair_grid(title, [p for p in pairs if p.path == name], asked.ends, shown))
            for name, title in titles.items()
        ],
        "pair_key": [(Markup(sign), words) for sign, words in pair_key(pairs)],
        "outcomes": [
            Markup(outcome_bars(title, _cells(record, name), asked.ends))
            for name, title in titles.items()
        ],
        "secondary": _secondary(record),
        "measured": "distance and clearance" if set(asked.metrics) <= set(VEHICLE) else "metrics",
        "thresholds": Markup(html(told)) if (told := by_threshold(record)) else "",
    }


def _interface(source: ReportInput) -> list[tuple[Markup, list[ChannelRows]]]:
    struck, wiring = struck_paths(source.record), Wiring(source.variants)
    meant = (fault.channel for fault in source.record.question.faults)
    part = concerned(source.interface, struck, meant, wiring)
    return [
        (
            Markup(draw_interface(shown, struck, source.variants, standalone=False)),
            tap_rows(shown, struck, wiring),
        )
        for shown in (part, source.interface)
        if shown is not None
    ]


def _secondary(record: DecisionRecord) -> list[Markup]:
    titles = _path_titles(record)
    named = [(titles.get(effect.path, effect.path), effect) for effect in record.effects]
    time = [(title, effect.time_s) for title, effect in named]
    metrics = (
        (
            each.headed(name),
            each.unit,
            [(title, effect.metrics.get(name)) for title, effect in named],
            each.better,
        )
        for name, each in record.question.metrics.items()
    )
    panels = (("Time on joint successes", "s", time, "less"), *metrics)
    return [
        Markup(secondary_panel(name, unit, rows, good))
        for name, unit, rows, good in panels
        if any(e and any((e.value, e.low, e.high)) for _, e in rows)
    ]
