"""The result as tables: one list of quantities, with the conditions as rows or as columns."""

from collections.abc import Sequence

from faultpath.analyses.effects import Effect
from faultpath.analyses.model import AuditResult, ConditionBreakEven
from faultpath.core.text import capital, counted
from faultpath.report.sentences import phrases, wording
from faultpath.report.sentences.headline import headline
from faultpath.report.sentences.phrases import adjusted, not_standing, only_alone
from faultpath.report.tables import MISSING, Entry, Line, Table, line, markdown_block
from faultpath.stats.estimate import Estimate

_VARIANTS = ("baseline", "repair")
_MEDIAN = "median time of successes"
DIFFERENCE = ("difference", "interval", "won")
SHOWN = (*_VARIANTS, *DIFFERENCE, "holm", "power", "scenes", "void", "break-even")
ALL = (
    *(*_VARIANTS, *DIFFERENCE, "p", "mcnemar", "holm", "ahead"),
    *("power", "scenes", "void", "break-even", "beta"),
)
_MEANS = {
    "power": "the true difference that 8 of 10 such audits would find",
    "scenes": "those in which both versions have a trial",
    "void": "pairs of trials that count for neither version",
    "break-even": "how often the fault must occur for neither version to be ahead",
}
"""Sentences on quantities that say little where they are the same under every condition."""
_BETA = (
    " Break-even beta: the same for the beta factor, the share of the module's faults that reach "
    "all modules at once."
)


def _quantities(
    result: AuditResult, names: Sequence[str]
) -> dict[str, tuple[str, list[str] | list[Entry]]]:
    """Return the quantities of `names` that the result has, each with its label and an entry for
    every condition."""
    effects, question = result.effects, result.question
    quantities: dict[str, tuple[str, list[str] | list[Entry]]] = {
        "baseline": (question.baseline, [wording.plain(e.rates[0]) for e in effects]),
        "repair": (question.repair, [wording.plain(e.rates[1]) for e in effects]),
        "difference": ("Difference, pp", list(map(_difference, effects))),
        "interval": ("95 % interval", [wording.interval(e) or MISSING for e in effects]),
        "won": ("Won:lost", [wording.won(e.won) for e in effects]),
        "p": ("p, alone", [_p(e.p_value) for e in effects]),
        "holm": (
            "p, Holm" if result.stopped is None else "p, family",
            [_p(e.corrected_p) for e in effects],
        ),
        "ahead": ("Ahead", [version_ahead(result, e) for e in effects]),
        "scenes": (f"{capital(result.facts.unit)}s", [str(e.scenes) for e in effects]),
        "void": ("Void pairs", list(map(_missing_pairs, effects))),
        "break-even": ("Break-even, %", _break_evens(result, result.break_even)),
        "mcnemar": ("p, exact McNemar", [_p(e.mcnemar_p) for e in effects]),
        "power": ("80 % power, pp", [wording.detectable(e) for e in effects]),
        "beta": ("Break-even beta, %", _break_evens(result, result.break_even_beta)),
    }
    there = {
        "mcnemar": any(effect.mcnemar_p is not None for effect in effects),
        "power": result.stopped is None,
        "beta": bool(result.break_even_beta),
    }
    return {name: quantities[name] for name in names if there.get(name, True)}


def _difference(effect: Effect) -> Entry:
    text, aside = wording.signed(effect.value), wording.reservation(effect)
    return Entry(text=text, detected=effect.significant, aside=aside)


def _missing_pairs(effect: Effect) -> Entry:
    return Entry(text=str(effect.void), tone="bad" if effect.void else "")


def _p(value: float | None) -> str:
    return MISSING if value is None else wording.p_value(value)


def _break_evens(result: AuditResult, shares: Sequence[ConditionBreakEven]) -> list[str]:
    texts = {share.condition: wording.break_even(share.result) for share in shares}
    return [texts.get(effect.condition, MISSING) for effect in result.effects]


def version_ahead(result: AuditResult, effect: Effect) -> Entry:
    """Return the version that is significantly ahead, with what keeps it out of a headline; or the
    p-value for which the difference is not significant where the interval alone excludes 0."""
    if not effect.acted:
        return Entry(text="not tested")
    variant = result.winner(effect.sign) if effect.sign else "not shown"
    p = adjusted(result, effect) if only_alone(effect) else ""
    aside = wording.reservation(effect)
    return Entry(text=variant, aside=", ".join(filter(None, (aside, p))))


def by_condition(result: AuditResult, names: Sequence[str], title: str = "") -> Table:
    """Return a table with a row for each condition and a column for each quantity in `names`."""
    quantities = _quantities(result, names)
    rows = zip(*(entries for _, entries in quantities.values()), strict=True)
    primary = [effect.condition == result.facts.primary for effect in result.effects]
    lines = [
        line(condition, *entries, aside="primary" if is_primary else "")
        for condition, entries, is_primary in zip(
            condition_titles(result), rows, primary, strict=True
        )
    ]
    columns = (
        label + (", %" if name in _VARIANTS else "") for name, (label, _) in quantities.items()
    )
    return Table(title=title, corner="Condition", columns=tuple(columns), lines=tuple(lines))


def constant(result: AuditResult, names: Sequence[str]) -> dict[str, str]:
    """Return which of the quantities in `names` are the same under every condition, each with a
    sentence on it; none where there is nothing to say."""
    same: dict[str, str] = {}
    for name, (label, entries) in _quantities(result, names).items():
        texts = {entry if isinstance(entry, str) else entry.text for entry in entries}
        if name in _MEANS and len(entries) > 1 and len(texts) == 1:
            (text,) = texts
            words = f"{label}, under every condition: {text} ({_MEANS[name]})."
            same[name] = "" if text == MISSING else words
    return same


def by_quantity(result: AuditResult, names: Sequence[str]) -> Table:
    """Return a table with a column for each condition and a row for each quantity in `names`."""
    return Table(
        name="faultpath",
        corner="Success, %",
        columns=condition_titles(result),
        lines=tuple(
            line(label, *entries, aside=name if name in _VARIANTS else "")
            for name, (label, entries) in _quantities(result, names).items()
        ),
    )


def markdown_table(result: AuditResult) -> str:
    """Return every quantity of every condition as Markdown, with the question above and the result
    below: the table of a paper."""
    question, facts = result.question, result.facts
    what = (
        f"{question.repair} against {question.baseline} on {facts.system}, fault {question.fault}"
    )
    if facts.judged:
        under = f", {question.fault}" if question.fault else ""
        what = f"{question.repair} against {question.baseline}{under}"
    library = "" if facts.judged else f" of {facts.library}"
    title = f"{what}: {phrases.scenes_run(result)}{library}{wording.seeds_run(facts)}"
    hypotheses, sets = result.testing.hypotheses, len(result.break_evens)
    corrected = f"Holm's correction is for {counted(hypotheses, 'contrast')}."
    if sets > 1:
        corrected += (
            f" Of {sets} break-even sets each is wrong in at most 5 % of audits, one or another of "
            "them in more."
        )
    if result.stopped is not None:
        corrected = (
            "The audit was sequential: intervals and p-values hold at whatever scene it stopped."
        )
        if hypotheses > 1:
            corrected += (
                f" Its {hypotheses} contrasts share the error rate, half of it for the primary one."
            )
    tests = f"Tests: {facts.tests}. " if facts.tests else ""
    notes = (
        f"Difference: success of {question.repair} minus success of {question.baseline}. Won:lost: "
        f"{facts.unit}s in which only {question.repair} or only {question.baseline} succeeds. "
        "Break-even: the fault frequencies at which neither is shown to be ahead, with the "
        "estimate in front; none: one is ahead at every frequency; any: no bound could be shown. "
        "A dash: there is nothing to compute it from." + (_BETA if result.break_even_beta else ""),
        f"Primary contrast: {facts.primary}. {tests}{corrected} Intervals and tests speak of "
        f"{phrases.estimand(question, facts)}.",
        *not_standing(result),
        headline(result),
    )
    table, more = by_quantity(result, ALL), secondary_table(result)
    lines = (*table.lines, line(more.title), *more.lines) if more else table.lines
    whole = table.model_copy(update={"title": title, "notes": notes, "lines": lines})
    return markdown_block(whole)


def ended(result: AuditResult) -> Table:
    """Return how the trials of both versions ended under each condition."""
    variants = result.question.baseline, result.question.repair
    statuses = ("success", "crash", "timeout", "failed")
    counts = {(count.condition, count.variant): count for count in result.counts}
    shown = [s for s in statuses if any(getattr(count, s) for count in result.counts)]
    time = () if median_time(result) else (f"{_MEDIAN}, s",)
    lines: list[Line] = []
    for condition in result.conditions:
        lines.append(line(condition.title))
        for role, name in zip(_VARIANTS, variants, strict=True):
            if (count := counts.get((condition.name, name))) is not None:
                entries = [str(getattr(count, status)) for status in shown]
                entries += [_median(count.median_time_s)] if time else []
                lines.append(line(name, *entries, aside=role))
    return Table(
        title="How trials ended",
        corner="Version",
        columns=(*(result.facts.ends.get(s, s) for s in shown), *time),
        lines=tuple(lines),
    )


def median_time(result: AuditResult) -> str:
    """Say the median time of successes where all versions and conditions have the same, or none."""
    times = {_median(count.median_time_s) for count in result.counts}
    if times == {MISSING}:
        return "No time of a success is known."
    if len(result.counts) < 2 or len(times) > 1:
        return ""
    return f"{capital(_MEDIAN)}, of each version under every condition: {min(times)} s."


def _median(time_s: float | None) -> str:
    return MISSING if time_s is None else wording.plain(time_s, 2)


def secondary_table(result: AuditResult) -> Table | None:
    """Return time and metrics, repair minus baseline, by condition, and success at each threshold
    of the chosen metric; `None` without any."""
    question = result.question
    rows = {"time on joint successes (s)": [_estimate(s.time_s) for s in result.secondary]}
    for name, metric in result.facts.metrics.items():
        if name == question.metric:
            rows |= _chosen_metric(result, f", {question.baseline} → {question.repair}")
            continue
        label = f"{metric.label(name)} ({metric.unit})"
        rows[label] = [_estimate(s.metrics.get(name)) for s in result.secondary]
    shown = {label: row for label, row in rows.items() if set(row) != {MISSING}}
    if not shown:
        return None
    return Table(
        title=f"Secondary, not tested: {question.repair} minus {question.baseline}",
        corner="Metric",
        columns=condition_titles(result),
        lines=tuple(line(label, *row) for label, row in shown.items()),
    )


def chosen_metric(result: AuditResult) -> Table | None:
    """Return the chosen metric and success at each threshold of it, with a row for each condition;
    `None` without."""
    question, rows = result.question, _chosen_metric(result)
    if not rows:
        return None
    return Table(
        title=f"Secondary, not tested: {question.baseline} → {question.repair}, difference",
        corner="Condition",
        columns=tuple(rows),
        lines=tuple(map(line, condition_titles(result), *rows.values())),
    )


def _chosen_metric(result: AuditResult, versions: str = "") -> dict[str, list[str]]:
    """Return the chosen metric and success at its thresholds, by condition; nothing without one.

    A trial succeeds at a threshold if it did not crash and its metric is on the better side.
    """
    question = result.question
    if not question.metric:
        return {}
    metric = result.facts.metrics[question.metric]
    label = metric.label(question.metric)
    sign = "≤" if metric.better == "less" else "≥"
    means: list[str] = []
    rows = {f"{label} ({metric.unit}){versions}": means}
    for secondary in result.secondary:
        difference = secondary.metrics.get(question.metric)
        if difference is None or secondary.metric_means is None:
            means.append(MISSING)
            continue
        digits = wording.digits_of(difference)
        one, two = (wording.plain(mean, digits) for mean in secondary.metric_means)
        means.append(f"{one} → {two}, {_estimate(difference)}")
    for number, at in enumerate(sorted(set(question.thresholds))):
        rates = rows[f"success if {label} {sign} {at:g} {metric.unit}, %"] = []
        for secondary in result.secondary:
            if len(secondary.thresholds) <= number:
                rates.append(MISSING)
                continue
            there = secondary.thresholds[number]
            one, two = map(wording.plain, (there.baseline_percent, there.repair_percent))
            rates.append(f"{one} → {two}, {wording.with_interval(there.difference)}")
    return rows


def _estimate(estimate: Estimate | None) -> str:
    if estimate is None:
        return MISSING
    return wording.with_interval(estimate, wording.digits_of(estimate))


def condition_titles(result: AuditResult) -> tuple[str, ...]:
    """Return the titles of the conditions, in the order of the effects."""
    return tuple(result.titles[effect.condition] for effect in result.effects)
