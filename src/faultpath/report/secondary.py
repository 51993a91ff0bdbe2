"""Time and metrics beside success as tables: told, never tested."""

from faultpath.analyses.model import AuditResult
from faultpath.report.sentences import wording
from faultpath.report.tables import MISSING, Table, line
from faultpath.stats.estimate import Estimate


def secondary(record: AuditResult) -> Table | None:
    """Return time and metrics, repair minus baseline, by condition, and success at each threshold
    of the chosen metric; `None` without any."""
    question = record.question
    rows = {"time on joint successes (s)": [_difference(of.time_s) for of in record.secondary]}
    for name, metric in record.facts.metrics.items():
        if name == question.metric:
            rows |= _chosen_metric(record, f", {question.baseline} → {question.repair}")
            continue
        label = f"{metric.label(name)} ({metric.unit})"
        rows[label] = [_difference(of.metrics.get(name)) for of in record.secondary]
    shown = {label: row for label, row in rows.items() if set(row) != {MISSING}}
    if not shown:
        return None
    return Table(
        title=f"Secondary, not tested: {question.repair} minus {question.baseline}",
        corner="Metric",
        columns=condition_titles(record),
        lines=tuple(line(label, *row) for label, row in shown.items()),
    )


def chosen_metric(record: AuditResult) -> Table | None:
    """Return the chosen metric and success at each threshold of it, with a row for each condition;
    `None` without."""
    question, rows = record.question, _chosen_metric(record)
    if not rows:
        return None
    return Table(
        title=f"Secondary, not tested: {question.baseline} → {question.repair}, difference",
        corner="Condition",
        columns=tuple(rows),
        lines=tuple(map(line, condition_titles(record), *rows.values())),
    )


def _chosen_metric(record: AuditResult, versions: str = "") -> dict[str, list[str]]:
    """Return the chosen metric and success at its thresholds, by condition; nothing without one.

    A trial succeeds at a threshold if it did not crash and its metric is on the better side.
    """
    question = record.question
    if not question.metric:
        return {}
    metric = record.facts.metrics[question.metric]
    label = metric.label(question.metric)
    sign = "≤" if metric.better == "less" else "≥"
    rows: dict[str, list[str]] = {f"{label} ({metric.unit}){versions}": []}
    (means,) = rows.values()
    for of in record.secondary:
        difference = of.metrics.get(question.metric)
        if difference is None or of.metric_means is None:
            means.append(MISSING)
            continue
        digits = wording.digits_of(difference)
        one, two = (wording.plain(mean, digits) for mean in of.metric_means)
        means.append(f"{one} → {two}, {_difference(difference)}")
    for number, at in enumerate(sorted(set(question.thresholds))):
        rates = rows[f"success if {label} {sign} {at:g} {metric.unit}, %"] = []
        for of in record.secondary:
            if len(of.thresholds) <= number:
                rates.append(MISSING)
                continue
            there = of.thresholds[number]
            one, two = map(wording.plain, (there.baseline_percent, there.repair_percent))
            rates.append(f"{one} → {two}, {wording.with_interval(there.difference)}")
    return rows


def _difference(estimate: Estimate | None) -> str:
    if estimate is None:
        return MISSING
    return wording.with_interval(estimate, wording.digits_of(estimate))


def condition_titles(record: AuditResult) -> tuple[str, ...]:
    """Return the titles of the conditions, in the order of the effects."""
    return tuple(record.titles[effect.condition] for effect in record.effects)
