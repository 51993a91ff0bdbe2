"""Success by thresholds of a metric, and the metric beside it: described, never decided."""

from faultpath.record import wording
from faultpath.record.model import DecisionRecord, Effect
from faultpath.tables import MISSING, Entry, Table, line


def by_threshold(record: DecisionRecord) -> Table | None:
    """Return the chosen metric and success at each threshold of it, path by path; `None` without.

    A trial succeeds at a threshold if it did not crash and its metric is on the better side.
    """
    asked = record.question
    if not asked.metric:
        return None
    metric = asked.metrics[asked.metric]
    said = metric.said(asked.metric)
    sign = "≤" if metric.better == "less" else "≥"
    lines = [
        line(f"{said} ({metric.unit})", *(_metric(each, asked.metric) for each in record.effects))
    ]
    for number, at in enumerate(asked.thresholds):
        lines.append(
            line(
                f"success if {said} {sign} {at:g} {metric.unit}, %",
                *(_success(effect, number) for effect in record.effects),
            )
        )
    titles = {path.name: path.title for path in record.paths}
    return Table(
        title=f"Secondary, nothing is decided: {asked.baseline} → {asked.repair}, difference",
        corner=f"{said}: {metric.better} is better",
        columns=tuple(titles.get(effect.path, effect.path) for effect in record.effects),
        lines=tuple(lines),
    )


def _metric(effect: Effect, name: str) -> Entry:
    found = effect.metrics.get(name)
    if found is None or effect.metric_means is None:
        return Entry(text=MISSING)
    one, two = effect.metric_means
    return Entry(text=f"{one:.3g} → {two:.3g}, {wording.with_interval(found, 3)}")


def _success(effect: Effect, number: int) -> Entry:
    if len(effect.thresholds) <= number:
        return Entry(text=MISSING)
    found = effect.thresholds[number]
    rates = f"{wording.plain(found.baseline_percent)} → {wording.plain(found.repair_percent)}"
    return Entry(text=f"{rates}, {wording.with_interval(found.difference)}")
