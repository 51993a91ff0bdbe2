"""The report as one page that opens without a network, as a notebook's cell, and as files."""

from pathlib import Path

from faultpath.analyses.effects import Effect
from faultpath.analyses.model import SHARED, AuditResult, where
from faultpath.analyses.pairs import PairKind, counts, is_sample, read_pairs
from faultpath.report.adding import adding, adding_panels
from faultpath.report.audit_tables import (
    SHOWN,
    by_condition,
    constant,
    ended,
    markdown_table,
    median_time,
    secondary_table,
)
from faultpath.report.effects import effect_rows, share_panels
from faultpath.report.frame import STYLES, render, write_pages
from faultpath.report.inputs import ReportInput
from faultpath.report.pair_grid import pair_grid, pair_key
from faultpath.report.sentences import phrases, wording, words
from faultpath.report.sentences.answers import answers
from faultpath.report.tables import html
from faultpath.report.taps import fork_panel, forks
from faultpath.report.viewer import viewer_data


def report_page(source: ReportInput) -> str:
    """Return the whole report as HTML: styles, scripts, pictures and data inside."""
    result, question, facts = source.record, source.record.question, source.record.facts
    pairs, sampled = read_pairs(source.trials, result), is_sample(source.trials)
    ended_as = {
        condition.name: counts(source.trials, result, condition.name)
        for condition in result.conditions
    }
    viewer = viewer_data(source, pairs)
    shown = viewer.shown if viewer else ()
    titles = result.titles
    significant = any(effect.sign for effect in result.effects)
    why = adding(source, pairs) if significant else None
    tables = (ended(result), secondary_table(result))
    effects, axis = effect_rows(result)
    listed = () if sampled else pairs
    grids = [
        (
            name,
            pair_grid(title, [p for p in listed if p.condition == name], kinds, facts.ends, shown),
        )
        for (name, title), kinds in zip(titles.items(), ended_as.values(), strict=True)
    ]
    (frequency, no_frequency), (beta, no_beta) = (share_panels(result, b) for b in (False, True))
    same = constant(result, SHOWN)
    shown_columns = [name for name in SHOWN if name not in same]
    return render(
        "report.html.j2",
        (*STYLES, "viewer.css"),
        ("cells.js", "page.js", "viewer.js"),
        result=result,
        words=words(result),
        estimand=phrases.estimand(question, facts),
        question=question,
        facts=facts,
        provenance=source.provenance,
        sources=source.provenance.code.data if facts.judged else {},
        n_trials=len(source.trials),
        conditions=titles,
        names=(question.baseline, question.repair),
        plain=answers(result),
        scenes_run=phrases.scenes_run(result),
        stopping=phrases.stopping(result),
        finding=_finding(result),
        changes=[(moved.turn, phrases.change(result, moved)) for moved in result.changes],
        adding=why,
        adding_panels=adding_panels(why) if why else (),
        missing=[pair for pair in pairs if pair.kind is PairKind.VOID],
        n_missing=sum(kinds[PairKind.VOID] for kinds in ended_as.values()),
        n_pairs=sum(sum(kinds.values()) for kinds in ended_as.values()),
        sampled=len({pair.scene for pair in pairs}) if sampled else 0,
        n_scenes=len(source.trials.scenes),
        effects=effects,
        axis=axis,
        numbers=html(by_condition(result, shown_columns, "Effects; bold is significant")),
        same=" ".join(filter(None, (*same.values(), median_time(result)))),
        tests=phrases.tests(result),
        fault=_fault(source),
        variants=list(zip(("baseline", "repair"), source.system.variants, strict=True)),
        forks=list(map(fork_panel, forks(source))),
        frequency=frequency,
        no_frequency=no_frequency,
        beta=beta,
        no_beta=no_beta,
        grids=grids,
        pair_key=pair_key(pairs),
        outcomes=[(table.title, html(table)) for table in filter(None, tables)],
        viewer=viewer,
    )


def _fault(source: ReportInput) -> str:
    interface = source.system.interface
    units = {c.name: interface.source(c.sources[0]).unit for c in interface.channels}
    facts, fault = source.record.facts, source.record.question.fault
    return wording.faults(facts, units) or str(fault or "As the system defines it.")


def write_report(source: ReportInput, folder: Path) -> list[Path]:
    """Write `report.html` and `table.md` into `folder`; return their paths."""
    pages = {"report.html": report_page(source), "table.md": markdown_table(source.record)}
    return write_pages(pages, folder)


def _finding(result: AuditResult) -> list[tuple[Effect, str]]:
    """Return the two effects of a reversal, each with where it holds; without one, nothing."""
    # Of an interaction only the change is significant: an effect alone may be a point estimate.
    for moved in result.changes:
        if moved.turn == "reversal":
            ends = ((result.effect(end), where(end)) for end in (moved.isolated, SHARED))
            return [(effect, place) for effect, place in ends if effect]
    return []
