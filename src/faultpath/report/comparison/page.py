"""Audits side by side, as a table, on the terminal, and as one page that needs no network."""

from collections.abc import Sequence

from markupsafe import Markup
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from faultpath.record import wording
from faultpath.report.comparison import facts, words
from faultpath.report.comparison.runs import Compared, titles
from faultpath.report.comparison.sweep import swept
from faultpath.report.effects import Rows, effect_row, panel, shared_axis
from faultpath.report.frame import render
from faultpath.report.tables import decided_for
from faultpath.tables import MISSING, Entry, Line, Table, line
from faultpath.tables.escapes import markdown as escaped
from faultpath.tables.html import html
from faultpath.tables.markdown import block
from faultpath.tables.terminal import drawn


def effects(runs: Sequence[Compared]) -> Table:
    """Return the effect of every run on every path; bold is decided, by its own audit."""
    labels = dict(zip(runs, facts.labels(runs), strict=True))
    levels = {f"{100 * e.success.level:g} % interval" for run in runs for e in run.record.effects}
    interval = levels.pop() if len(levels) == 1 else "interval"
    return Table(
        title=f"{'All sizes together' if swept(runs) else 'Each run by itself'}; bold is decided",
        corner="Run",
        columns=("Baseline → repair, %", f"Difference, pp [{interval}]", "Decided for"),
        lines=tuple(
            each
            for path, title in titles(runs).items()
            for each in (line(title), *(_line(run, labels[run], path) for run in runs))
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
    found = facts.differing(runs)
    parts: list[RenderableType] = [Text(words.headline(runs), style="bold"), Text("")]
    for run in runs:
        verdict = Padding.indent(Text(run.headline), 3)
        parts += [Text(f"{run.number}  {run.folder}"), verdict]
    parts += [Text(""), drawn(effects(runs)), Text("")]
    parts += [drawn(facts.table(runs, found))] if found else [Text(words.same(runs))]
    return Group(*parts, Text(""), *map(Text, words.sentences(runs)))


def markdown(runs: Sequence[Compared]) -> str:
    """Return the comparison as Markdown, for a notebook."""
    found = facts.differing(runs)
    parts = (effects(runs), *([facts.table(runs, found)] if found else []))
    said = (escaped(each) for each in (words.headline(runs), *words.sentences(runs)))
    return "\n\n".join((*said, *map(block, parts)))


def page(runs: Sequence[Compared]) -> str:
    """Return the comparison as one page."""
    found, labels = facts.differing(runs), facts.labels(runs)
    panels: dict[str, Rows] = {
        title: [
            (label, effect_row(label, effect) if (effect := run.effect(path)) else run.absent(path))
            for label, run in zip(labels, runs, strict=True)
        ]
        for path, title in titles(runs).items()
    }
    axis = shared_axis(list(panels.values()))
    return render(
        "comparison.html.j2",
        ("tokens.css", "svg.css", "page.css"),
        (),
        headline=words.headline(runs),
        sentences=words.sentences(runs),
        runs=runs,
        panels=[Markup(panel(title, rows, axis)) for title, rows in panels.items()],
        effects=Markup(html(effects(runs))),
        facts=Markup(html(facts.table(runs, found))) if found else "",
        same=words.same(runs),
        sizes=swept(runs),
        w=wording,
    )
