"""Audits side by side, as a table, on the terminal, and as one page that needs no network."""

from collections.abc import Iterator, Sequence

from markupsafe import Markup
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from faultpath.decisions import wording
from faultpath.decisions.model import Effect
from faultpath.decisions.tables import MISSING, Entry, Line, Table, line
from faultpath.decisions.tables.html import html
from faultpath.decisions.tables.terminal import drawn
from faultpath.decisions.wording import series
from faultpath.report.comparison import sweep
from faultpath.report.comparison.runs import (
    Compared,
    differing,
    facts_table,
    labels,
    titles,
)
from faultpath.report.effects import Row, panel, shared_axis
from faultpath.report.frame import render
from faultpath.report.tables import decided_for

_NO_TEST = (
    "Setting verdicts side by side is no test between the audits: where one detects a difference "
    "and another does not, the two are not shown to differ."
)


def headline(runs: Sequence[Compared]) -> str:
    """Return how many audits there are, and where they are decided in opposite directions."""
    where = [title for path, title in titles(runs).items() if list(_opposite(runs, path))]
    found = sweep.swept(runs)
    count = f"{len(runs)} {f'sizes of {found.name}' if found else 'audits'} side by side"
    return f"{count}: decided in opposite directions on {series(where)}" if where else count


def same(runs: Sequence[Compared]) -> str:
    """Return what to say of runs between which nothing differs."""
    alike = len({run.provenance.outcomes_sha256 for run in runs}) == 1
    outcomes = "and so are the outcomes, bit for bit" if alike else "and yet outcomes differ"
    return f"Question, code, data files, packages and machine are the same, {outcomes}."


def sentences(runs: Sequence[Compared]) -> tuple[str, ...]:
    """Return the caveat, where audits are decided in opposite directions, and what qualifies it.

    Audits of other arms ask something else, and are not held against each other.
    """
    told = [
        f"{title}: decided {sides}."
        for path, title in titles(runs).items()
        for sides in _opposite(runs, path)
    ]
    if not told and len({_arms(run) for run in runs}) == len(runs):
        told = ["No two of these audits compare the same arms, so none can contradict another."]
    told = told or ["No two audits of the same arms are decided in opposite directions."]
    if len({run.asked.system for run in runs}) > 1:
        told += ["The runs are of different systems: the same name need not mean the same thing."]
    return (_NO_TEST, *sweep.sentences(runs), *told)


def _opposite(runs: Sequence[Compared], path: str) -> Iterator[str]:
    """Yield which runs are decided for which arm, for arms that win in some runs and lose in
    others: `for a (baseline) in 1, for b (repair) in 2 and 3`."""
    decided = [(run, effect) for run in runs if (effect := run.effect(path)) and effect.sign]
    for arms in dict.fromkeys(_arms(run) for run, _ in decided):
        there = [(run, effect) for run, effect in decided if _arms(run) == arms]
        if len({_winner(*each) for each in there}) < 2:
            continue
        sides: dict[str, list[str]] = {}
        for run, effect in there:
            side = f"{_winner(run, effect)} ({'repair' if effect.sign > 0 else 'baseline'})"
            aside = wording.reservation(effect)
            told = f"{run.number} (at the {aside})" if aside else f"{run.number}"
            sides.setdefault(side, []).append(told)
        yield ", ".join(f"for {side} in {series(said)}" for side, said in sides.items())


def _arms(run: Compared) -> frozenset[str]:
    return frozenset((run.asked.baseline, run.asked.repair))


def _winner(run: Compared, effect: Effect) -> str:
    return run.asked.repair if effect.sign > 0 else run.asked.baseline


def effects(runs: Sequence[Compared]) -> Table:
    """Return the effect of every run on every path; bold is decided, by its own audit."""
    label = dict(zip(runs, labels(runs), strict=True))
    levels = {f"{100 * e.success.level:g} % interval" for run in runs for e in run.record.effects}
    interval = levels.pop() if len(levels) == 1 else "interval"
    return Table(
        title=f"{'All sizes' if sweep.swept(runs) else 'Each run by itself'}; bold is decided",
        corner="Run",
        columns=("Baseline → repair, %", f"Difference, pp [{interval}]", "Decided for"),
        lines=tuple(
            each
            for path, title in titles(runs).items()
            for each in (line(title), *(_line(run, label[run], path) for run in runs))
        ),
        words=("Decided for",),
    )


def _line(run: Compared, label: str, path: str) -> Line:
    effect = run.effect(path)
    if effect is None:
        return line(label, MISSING, MISSING, run.absent(path))
    rates = map(wording.plain, (effect.baseline_percent, effect.repair_percent))
    difference = Entry(text=wording.with_interval(effect.success), detected=effect.detected)
    return line(label, " → ".join(rates), difference, decided_for(run.record, effect))


def shown(runs: Sequence[Compared]) -> RenderableType:
    """Return the comparison for a terminal."""
    found = differing(runs)
    parts: list[RenderableType] = [Text(headline(runs), style="bold"), Text("")]
    for run in runs:
        verdict = Padding.indent(Text(run.headline), 3)
        parts += [Text(f"{run.number}  {run.folder}"), verdict]
    parts += [Text(""), drawn(effects(runs)), Text("")]
    parts += [drawn(facts_table(runs, found))] if found else [Text(same(runs))]
    return Group(*parts, Text(""), *map(Text, sentences(runs)))


def page(runs: Sequence[Compared]) -> str:
    """Return the comparison as one page."""
    found = differing(runs)
    panels: dict[str, list[Row]] = {
        title: [
            (label, "", run.effect(path) or run.absent(path))
            for label, run in zip(labels(runs), runs, strict=True)
        ]
        for path, title in titles(runs).items()
    }
    axis = shared_axis(list(panels.values()))
    return render(
        "comparison.html.j2",
        ("tokens.css", "svg.css", "page.css"),
        (),
        headline=headline(runs),
        sentences=sentences(runs),
        runs=runs,
        panels=[Markup(panel(title, rows, axis)) for title, rows in panels.items()],
        effects=Markup(html(effects(runs))),
        facts=Markup(html(facts_table(runs, found))) if found else "",
        same=same(runs),
        sizes=sweep.swept(runs),
        w=wording,
    )
