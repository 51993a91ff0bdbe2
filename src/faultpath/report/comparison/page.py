"""Audits side by side, as a table, on the terminal, and as one page that needs no network."""

from collections.abc import Sequence
from dataclasses import replace

from markupsafe import Markup
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from faultpath.record import wording
from faultpath.report.comparison import facts, words
from faultpath.report.comparison.runs import Compared, titles
from faultpath.report.comparison.sweep import COURSE, swept
from faultpath.report.comparison.turning import turning
from faultpath.report.figures.effects import EffectRow, effect_rows
from faultpath.report.figures.multiples import Rows, multiple, shared_axis
from faultpath.report.figures.over_sizes import over_sizes
from faultpath.report.frame import render
from faultpath.report.tables import decided_for
from faultpath.tables import MISSING, Entry, Line, Table, line
from faultpath.tables.escapes import markdown as escaped
from faultpath.tables.html import html
from faultpath.tables.markdown import block
from faultpath.tables.terminal import drawn
from faultpath.version import __version__


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
    return line(label, " → ".join(rates), difference, decided_for(run.asked, effect))


def shown(runs: Sequence[Compared]) -> RenderableType:
    """Return the comparison for a terminal."""
    found = facts.differing(runs)
    parts: list[RenderableType] = [Text(words.headline(runs), style="bold"), Text("")]
    for run in runs:
        verdict = Padding.indent(Text(run.headline), 3)
        parts += [Text(f"{run.number}  {run.folder}"), verdict]
    parts += [Text(""), drawn(effects(runs)), Text("")]
    parts += [drawn(facts.table(runs, found))] if found else [Text(words.same(runs))]
    if turns := turning(runs):
        parts += [Text(""), drawn(turns), *map(Text, turns.notes)]
    return Group(*parts, Text(""), *map(Text, words.sentences(runs)))


def markdown(runs: Sequence[Compared]) -> str:
    """Return the comparison as Markdown, for a notebook."""
    found = facts.differing(runs)
    parts = (effects(runs), *([facts.table(runs, found)] if found else []))
    said = (escaped(each) for each in (words.headline(runs), *words.sentences(runs)))
    return "\n\n".join((*said, *map(block, parts)))


def page(runs: Sequence[Compared]) -> str:
    """Return the comparison as one page."""
    found, panels = facts.differing(runs), _panels(runs)
    axis = shared_axis([rows for _, rows in panels])
    sizes, turns = swept(runs), turning(runs)
    drawn_over = sizes if len(runs) >= COURSE else None
    return render(
        "comparison.html.j2",
        ("tokens.css", "svg.css", "page.css", "comparison.css"),
        (),
        version=__version__,
        headline=words.headline(runs),
        sentences=words.sentences(runs),
        runs=runs,
        panels=[
            Markup(
                over_sizes(title, drawn_over, rows, axis)
                if drawn_over
                else multiple(title, rows, axis)
            )
            for title, rows in panels
        ],
        effects=Markup(html(effects(runs))),
        facts=Markup(html(facts.table(runs, found))) if found else "",
        same=words.same(runs),
        sizes=sizes,
        turns=Markup(html(turns)) if turns else "",
        turns_notes=turns.notes if turns else (),
        w=wording,
    )


def _panels(runs: Sequence[Compared]) -> list[tuple[str, Rows]]:
    labels = facts.labels(runs)
    return [
        (title, [(label, _row(run, path)) for label, run in zip(labels, runs, strict=True)])
        for path, title in titles(runs).items()
    ]


def _row(run: Compared, path: str) -> EffectRow | str:
    effect = run.effect(path)
    if effect is None:
        return run.absent(path)
    row = next(
        row
        for row, own in zip(effect_rows(run.record), run.record.effects, strict=True)
        if own.path == path
    )
    return replace(row, note=wording.reservation(effect), sign=effect.sign)
