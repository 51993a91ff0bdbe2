"""The record as tables: one list of quantities, with the conditions as rows or as columns."""

from collections.abc import Mapping, Sequence

from faultpath.analyses.effects import Effect
from faultpath.analyses.model import AuditResult
from faultpath.core.text import capital, counted
from faultpath.report.secondary import condition_titles, secondary
from faultpath.report.sentences import phrases, wording
from faultpath.report.sentences.headline import headline
from faultpath.report.sentences.phrases import adjusted, not_standing, only_alone
from faultpath.report.tables import MISSING, Entry, Line, Table, line
from faultpath.report.tables.markdown import block

_VARIANTS = ("baseline", "repair")
_MEDIAN = "median time of successes"
DIFFERENCE = ("difference", "interval", "won")
SHOWN = (*_VARIANTS, *DIFFERENCE, "holm", "power", "scenes", "void", "break-even")
ALL = (
    *(*_VARIANTS, *DIFFERENCE, "p", "mcnemar", "holm", "decided"),
    *("power", "scenes", "void", "break-even", "beta"),
)
_MEANS = {
    "power": "the true difference that 8 of 10 such audits would find",
    "scenes": "scenes in which both versions have a trial",
    "void": "pairs of trials that count for neither version",
    "break-even": "how often the fault must occur for neither version to be ahead",
}
"""Sentences on quantities that say little where they are the same under every condition."""
_BETA = (
    " Break-even beta: the same for the beta factor, the share of the module's faults that reach "
    "all modules at once."
)


def _entries(record: AuditResult, effect: Effect) -> Mapping[str, Entry | str]:
    """Return all that a record says of a condition, by the name of the quantity."""
    break_evens = {b.condition: wording.break_even(b.result) for b in record.break_even}
    betas = {b.condition: wording.break_even(b.result) for b in record.break_even_beta}
    beside = effect.mcnemar_p
    return {
        "baseline": wording.plain(effect.rates[0]),
        "repair": wording.plain(effect.rates[1]),
        "difference": Entry(
            text=wording.signed(effect.value),
            detected=effect.significant,
            aside=wording.reservation(effect),
        ),
        "interval": wording.interval(effect) or MISSING,
        "won": wording.won(effect.won),
        "p": wording.p_value(effect.p_value),
        "mcnemar": MISSING if beside is None else wording.p_value(beside),
        "holm": MISSING if effect.corrected_p is None else wording.p_value(effect.corrected_p),
        "decided": decided_for(record, effect),
        "power": wording.detectable(effect),
        "scenes": str(effect.scenes),
        "void": Entry(text=str(effect.void), tone="bad" if effect.void else ""),
        "break-even": break_evens.get(effect.condition, MISSING),
        "beta": betas.get(effect.condition, MISSING),
    }


def _labels(record: AuditResult, names: Sequence[str]) -> dict[str, str]:
    """Return the quantities of `names` that the record has, each with its label."""
    effects, question = record.effects, record.question
    labels = {
        "baseline": question.baseline,
        "repair": question.repair,
        "difference": "Difference, pp",
        "interval": "95 % interval",
        "won": "Won:lost",
        "p": "p, alone",
        "mcnemar": "p, exact McNemar",
        "holm": "p, Holm" if record.stopped is None else "p, family",
        "decided": "Ahead",
        "power": "80 % power, pp",
        "scenes": "Scenes",
        "void": "Void pairs",
        "break-even": "Break-even, %",
        "beta": "Break-even beta, %",
    }
    there = {
        "power": record.stopped is None,
        "beta": bool(record.break_even_beta),
        "mcnemar": any(effect.mcnemar_p is not None for effect in effects),
    }
    return {name: labels[name] for name in names if there.get(name, True)}


def decided_for(record: AuditResult, effect: Effect) -> Entry:
    """Return the version that is significantly ahead, with what keeps it out of a headline; or the
    p-value for which the difference is not significant where the interval alone excludes 0."""
    if not effect.acted:
        return Entry(text="not tested")
    variant = record.winner(effect.sign) if effect.sign else "not shown"
    p = adjusted(record, effect) if only_alone(effect) else ""
    return Entry(text=variant, aside=", ".join(filter(None, (effect.extreme, p))))


def by_condition(record: AuditResult, names: Sequence[str], title: str = "") -> Table:
    """Return a table with a row for each condition and a column for each quantity in `names`."""
    labels, titles = _labels(record, names), condition_titles(record)
    lines = [
        line(
            title_of,
            *(_entries(record, effect)[name] for name in labels),
            aside="primary" if effect.condition == record.facts.primary else "",
        )
        for title_of, effect in zip(titles, record.effects, strict=True)
    ]
    columns = (label + (", %" if name in _VARIANTS else "") for name, label in labels.items())
    return Table(title=title, corner="Condition", columns=tuple(columns), lines=tuple(lines))


def constant(record: AuditResult, names: Sequence[str]) -> dict[str, str]:
    """Return which of the quantities in `names` are the same under every condition, each with a
    sentence on it; none where there is nothing to say."""
    of = [_entries(record, effect) for effect in record.effects]
    same: dict[str, str] = {}
    for name, label in _labels(record, names).items():
        cells = (entries[name] for entries in of)
        texts = {entry if isinstance(entry, str) else entry.text for entry in cells}
        if name in _MEANS and len(of) > 1 and len(texts) == 1:
            (text,) = texts
            words = f"{label}, under every condition: {text} ({_MEANS[name]})."
            same[name] = "" if text == MISSING else words
    return same


def by_quantity(
    record: AuditResult, names: Sequence[str], title: str = "", notes: Sequence[str] = ()
) -> Table:
    """Return a table with a column for each condition and a row for each quantity in `names`."""
    of = [_entries(record, effect) for effect in record.effects]
    return Table(
        name="faultpath",
        title=title,
        corner="Success, %",
        columns=condition_titles(record),
        lines=tuple(
            line(label, *(entries[name] for entries in of), aside=name if name in _VARIANTS else "")
            for name, label in _labels(record, names).items()
        ),
        notes=tuple(notes),
    )


def whole_table(record: AuditResult) -> Table:
    """Return every quantity of every condition, with the question as title: the table of a
    paper."""
    question, facts = record.question, record.facts
    what = (
        f"{question.repair} against {question.baseline} on {facts.system}, fault {question.fault}"
    )
    scenes = f"scenes of {facts.library}"
    if facts.judged:
        under = f", {question.fault}" if question.fault else ""
        what, scenes = f"{question.repair} against {question.baseline}{under}", f"{facts.unit}s"
    title = f"{what}: {phrases.scenes_run(record)} {scenes}{wording.seeds_run(facts)}"
    hypotheses, sets = record.testing.hypotheses, len(record.break_evens)
    corrected = f"Holm's correction is for {hypotheses} contrasts."
    if sets > 1:
        corrected += (
            f" Of {sets} break-even sets each is wrong in at most 5 % of audits, one or another of "
            "them in more."
        )
    if record.stopped is not None:
        corrected = (
            "The audit was sequential: intervals and p-values hold at whatever scene it stopped. "
            f"{counted(hypotheses, 'contrast')} share the error rate"
            f"{', half of it for the primary one' if hypotheses > 1 else ''}."
        )
    tests = f"Tests: {facts.tests}. " if facts.tests else ""
    notes = (
        f"Difference: success of {question.repair} minus success of {question.baseline}. Won:lost: "
        f"scenes in which only {question.repair} or only {question.baseline} succeeds. Break-even: "
        "the fault frequencies at which neither is shown to be ahead, with the estimate in front; "
        "any: no bound could be shown. A dash: there is nothing to compute it from."
        + (_BETA if record.break_even_beta else ""),
        f"Primary contrast: {facts.primary}. {tests}{corrected} Intervals and tests speak of "
        f"{phrases.estimand(question, facts)}.",
        *not_standing(record),
        headline(record),
    )
    table = by_quantity(record, ALL, title, notes)
    more = secondary(record)
    heading = (line(more.title), *more.lines) if more else ()
    return table.model_copy(update={"lines": (*table.lines, *heading)})


def markdown_table(record: AuditResult) -> str:
    """Return the whole table as Markdown, with the question above it and the verdict below."""
    return block(whole_table(record))


def ended(record: AuditResult) -> Table:
    """Return how the trials of both versions ended under each condition."""
    question = record.question
    statuses = ("success", "crash", "timeout", "failed")
    counts = {(count.condition, count.variant): count for count in record.counts}
    shown = [s for s in statuses if any(getattr(count, s) for count in record.counts)]
    lines: list[Line] = []
    for condition in record.conditions:
        lines.append(line(condition.title))
        for role, name in zip(_VARIANTS, (question.baseline, question.repair), strict=True):
            if (count := counts.get((condition.name, name))) is not None:
                ends = (str(getattr(count, status)) for status in shown)
                time = () if median_time(record) else (_median(count.median_time_s),)
                lines.append(line(name, *ends, *time, aside=role))
    time = () if median_time(record) else (f"{_MEDIAN}, s",)
    return Table(
        title="How trials ended",
        corner="Version",
        columns=(*(record.facts.ends.get(s, s) for s in shown), *time),
        lines=tuple(lines),
    )


def median_time(record: AuditResult) -> str:
    """Say the median time of successes where all versions and conditions have the same, or none."""
    times = {_median(count.median_time_s) for count in record.counts}
    if times == {MISSING}:
        return "No time of a success is known."
    same = len(record.counts) > 1 and len(times) == 1
    return (
        f"{capital(_MEDIAN)}, of each version under every condition: {min(times)} s."
        if same
        else ""
    )


def _median(time_s: float | None) -> str:
    return MISSING if time_s is None else wording.plain(time_s, 2)
