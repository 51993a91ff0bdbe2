"""Finished audits beside each other in words, as tables, on the terminal and as a page."""

from collections.abc import Iterator, Sequence

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from faultpath.analyses.effects import Effect
from faultpath.analyses.family import ALPHA
from faultpath.analyses.model import where
from faultpath.core.text import series, shortened
from faultpath.report.audit_tables import version_ahead
from faultpath.report.compared import (
    Compared,
    Facts,
    differing,
    labels,
    same_correct_trials,
    swept,
    titles,
)
from faultpath.report.effects import Row, panel, shared_axis
from faultpath.report.frame import render
from faultpath.report.sentences import wording
from faultpath.report.sentences.findings import of_audit
from faultpath.report.sentences.phrases import scenes_run
from faultpath.report.svg import tick_label
from faultpath.report.tables import MISSING, Entry, Line, Table, html, line
from faultpath.report.terminal import Parted, drawn
from faultpath.run.store.folder import OUTCOMES

_LABEL = 28
"""Letters of a label on the terminal."""
_NOTHING = "nothing significant"


def headline(runs: Sequence[Compared]) -> str:
    """Return what all sizes of a sweep answer under the primary condition; of other runs how many
    there are, and where they are significant in opposite directions."""
    if sweep := swept(runs):
        primary = runs[0].record.facts.primary
        answer = _by_size(runs, primary, sweep[1])
        return f"{len(runs)} sizes of {sweep[0]}, {where(primary)}: {answer}"
    opposed = [
        title for condition, title in titles(runs).items() if list(_opposite(runs, condition))
    ]
    count = f"{len(runs)} audits side by side"
    return f"{count}: significant in opposite directions on {series(opposed)}" if opposed else count


def same(runs: Sequence[Compared]) -> str:
    """Return what to say of runs between which nothing differs."""
    alike = len({run.provenance.files[OUTCOMES] for run in runs}) == 1
    outcomes = "and so are the outcomes, bit for bit" if alike else "and yet outcomes differ"
    return f"Question, code, data files, packages and machine are the same, {outcomes}."


def sentences(runs: Sequence[Compared]) -> tuple[str, ...]:
    """Return what is significant over all sizes, where audits of the same variants are significant
    in opposite directions, what qualifies it, and the caveat."""
    conclusions = [
        f"{title}: significant {sides}."
        for condition, title in titles(runs).items()
        for sides in _opposite(runs, condition)
    ]
    if not conclusions:
        conclusions = (
            ["No two of these audits compare the same versions, so none can contradict another."]
            if len({_variants(run) for run in runs}) == len(runs)
            else ["No two audits of the same versions are significant in opposite directions."]
        )
    if len({run.record.facts.system for run in runs}) > 1:
        conclusions += [
            "The runs are of different systems: the same name need not mean the same thing."
        ]
    caveat = (
        "The audits are not compared with each other: where a difference is significant in one and "
        "not in another, the two are not shown to differ."
    )
    return *_over_sizes(runs), *conclusions, caveat


def _over_sizes(runs: Sequence[Compared]) -> Iterator[str]:
    """Yield what is significant over all sizes; nothing for runs that are no sweep."""
    sweep = swept(runs)
    if sweep is None:
        return
    for condition, title in titles(runs).items():
        yield f"{title}: {_by_size(runs, condition, sweep[1])}."
    if same_correct_trials(runs):
        yield "Correct inputs are the same trials at every size, and count once."
    yield (
        f"All {len(runs)} sizes are one family here: what is called significant, and what is bold, "
        f"is wrong in at most {100 * ALPHA:g} % of such sweeps, all sizes together (Holm)."
    )


def _by_size(runs: Sequence[Compared], condition: str, sizes: Sequence[float]) -> str:
    """Return who is ahead at which sizes: `gru ahead at 0.1; nothing significant at 0.05`."""
    by_answer: dict[str, list[str]] = {}
    for run, size in sorted(zip(runs, sizes, strict=True), key=lambda pair: pair[1]):
        effect, words = run.effect(condition), _NOTHING
        if effect is None:
            words = run.absent(condition)
        elif not effect.acted:
            words = wording.reservation(effect)
        elif effect.sign:
            words = f"{run.record.winner(effect.sign)} ahead{_aside(effect)}"
        by_answer.setdefault(words, []).append(tick_label(size))
    if len(by_answer) == 1:
        (words,) = by_answer
        return f"{words} at {'any' if words == _NOTHING else 'every'} size"
    return "; ".join(f"{words} at {series(ticks)}" for words, ticks in by_answer.items())


def _aside(effect: Effect) -> str:
    """Return what keeps a significant effect out of a headline, to stand behind who is ahead."""
    aside = wording.reservation(effect)
    return f" ({aside})" if aside else ""


def _opposite(runs: Sequence[Compared], condition: str) -> Iterator[str]:
    """Yield in which runs which variant is significantly ahead, for variants that win in some runs
    and lose in others: `for a (baseline) in 1, for b (repair) in 2 and 3`."""
    significant = [
        (run, effect) for run in runs if (effect := run.effect(condition)) and effect.sign
    ]
    for variants in dict.fromkeys(_variants(run) for run, _ in significant):
        sides: dict[str, dict[str, list[str]]] = {}
        for run, effect in significant:
            if _variants(run) != variants:
                continue
            role = "repair" if effect.sign > 0 else "baseline"
            winner = run.record.winner(effect.sign)
            numbers = sides.setdefault(winner, {}).setdefault(f"{winner} ({role})", [])
            numbers.append(f"{run.number}{_aside(effect)}")
        if len(sides) > 1:
            clauses = [clause for by_role in sides.values() for clause in by_role.items()]
            yield ", ".join(f"for {side} in {series(numbers)}" for side, numbers in clauses)


def _variants(run: Compared) -> frozenset[str]:
    return frozenset((run.record.question.baseline, run.record.question.repair))


def facts_table(runs: Sequence[Compared], facts: Facts) -> Table:
    """Return what differs, each value with the runs that have it."""
    lines: list[Line] = []
    for title, values in facts.items():
        lines.append(line(title))
        for value in dict.fromkeys(values):
            numbers = [str(run.number) for run, v in zip(runs, values, strict=True) if v == value]
            lines.append(line(value, series(numbers)))
    columns = ("Runs",)
    return Table(
        title="What differs", corner="Value", columns=columns, words=columns, lines=tuple(lines)
    )


def effects(runs: Sequence[Compared]) -> Table:
    """Return the effect of every run under every condition; bold is significant, by its own
    audit."""
    lines: list[Line] = []
    for condition, title in titles(runs).items():
        lines.append(line(title))
        for run, label in zip(runs, labels(runs), strict=True):
            if (effect := run.effect(condition)) is None:
                lines.append(line(label, MISSING, MISSING, run.absent(condition)))
                continue
            rates = map(wording.plain, effect.rates)
            difference = Entry(text=wording.with_interval(effect), detected=effect.significant)
            ahead = version_ahead(run.record, effect)
            lines.append(line(label, " → ".join(rates), difference, ahead))
    return Table(
        title=f"{'All sizes' if swept(runs) else 'Each run by itself'}; bold is significant",
        corner="Run",
        columns=("Baseline → repair, %", "Difference, pp [95 % interval]", "Ahead"),
        lines=tuple(lines),
        words=("Ahead",),
    )


def shown(runs: Sequence[Compared]) -> RenderableType:
    """Return the comparison for a terminal."""
    facts = differing(runs)
    parts: list[RenderableType] = [Text(headline(runs), style="bold"), Text("")]
    for run in runs:
        parts += [Text(f"{run.number}  {run.folder}"), Padding.indent(Text(run.headline), 3)]
    parts += [Text(""), Parted(_short(effects(runs))), Text("")]
    parts += [drawn(facts_table(runs, facts))] if facts else [Text(same(runs))]
    return Group(*parts, Text(""), *map(Text, sentences(runs)))


def _short(table: Table) -> Table:
    """Return a table whose labels leave room for its numbers; above it stand the whole names."""
    lines = [row.model_copy(update={"label": shortened(row.label, _LABEL)}) for row in table.lines]
    return table.model_copy(update={"lines": tuple(lines), "words": ()})


def page(runs: Sequence[Compared]) -> str:
    """Return the comparison as one page."""
    facts = differing(runs)
    panels: dict[str, list[Row]] = {
        title: [
            (label, run.effect(condition) or run.absent(condition))
            for label, run in zip(labels(runs), runs, strict=True)
        ]
        for condition, title in titles(runs).items()
    }
    effects_of = (run.effect(condition) for run in runs for condition in titles(runs))
    axis = shared_axis(effect for effect in effects_of if effect)
    return render(
        "comparison.html.j2",
        headline=headline(runs),
        sentences=sentences(runs),
        runs=[(run, scenes_run(run.record), of_audit(run.record)) for run in runs],
        panels=[panel(title, rows, axis) for title, rows in panels.items()],
        effects=html(effects(runs)),
        facts=html(facts_table(runs, facts)) if facts else "",
        same=same(runs),
        sizes=swept(runs),
    )
