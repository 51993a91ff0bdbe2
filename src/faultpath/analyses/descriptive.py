"""Descriptive numbers of a condition, without tests: how trials ended, times, metrics."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from faultpath.analyses.effects import AtThreshold, Secondary
from faultpath.analyses.facts import ComparisonFacts, Question
from faultpath.analyses.model import CORRECT, Condition, VariantCounts
from faultpath.run.pairing import Pairs
from faultpath.run.trials import Bools, Trials
from faultpath.stats.effects import mean_effect, median_effect, seed_sums, success_effect
from faultpath.stats.estimate import Estimate
from faultpath.stats.inputs import Floats
from faultpath.stats.power import MIN_SCENES
from faultpath.stats.resamples import Resamples
from faultpath.system.outcome import Metric, Status


def percent(success: Floats) -> float:
    """Return success `[scenes, seeds]` in percent, over scenes; NaN where a pair did not run."""
    ran = success[~np.isnan(success).all(axis=1)]
    return 100.0 * float(seed_sums(ran).sum()) / ran.size


def counts_of(
    question: Question, conditions: Sequence[Condition], trials: Trials
) -> tuple[VariantCounts, ...]:
    """Return how the trials of both versions ended under every condition."""
    counts: list[VariantCounts] = []
    for condition in conditions:
        for variant in (question.baseline, question.repair):
            rows = trials.rows(variant, condition.name).ravel()
            rows = rows[rows >= 0]
            ended = {status: int(trials.has(status)[rows].sum()) for status in Status}
            ran = len(rows) - ended[Status.FAILED]
            times = trials.time_s[rows[trials.has(Status.SUCCESS)[rows]]]
            times = times[np.isfinite(times)]
            faulted, altered = (trials.steps[:, rows] > 0).sum(axis=1).tolist()
            counts.append(
                VariantCounts(
                    variant=variant,
                    condition=condition.name,
                    trials=len(rows),
                    success=ended[Status.SUCCESS],
                    crash=ended[Status.CRASH],
                    timeout=ended[Status.TIMEOUT],
                    failed=ended[Status.FAILED],
                    success_percent=100 * ended[Status.SUCCESS] / ran if ran else 0.0,
                    median_time_s=float(np.median(times)) if len(times) else None,
                    faulted_trials=faulted,
                    altered_trials=altered,
                )
            )
    return tuple(counts)


def untested_conditions(
    conditions: Sequence[Condition], counts: Sequence[VariantCounts]
) -> tuple[str, ...]:
    """Return the conditions on which the fault changed nothing in any trial."""
    acted = {count.condition for count in counts if count.altered_trials}
    return tuple(
        condition.name
        for condition in conditions
        if condition.name != CORRECT and condition.name not in acted
    )


def secondary(
    condition: str, pairs: Pairs, question: Question, facts: ComparisonFacts
) -> Secondary:
    """Return time and metrics under a condition, over the scenes of which every seed has both
    outcomes, for new scenes and the seeds run."""
    pairs = pairs.whole()
    if not pairs.scenes:
        return Secondary(condition=condition)
    library, scenes = facts.library_hash, len(pairs.scenes)
    repair, baseline = pairs.ended(Status.SUCCESS)
    times = pairs.time_s
    joint = repair & baseline
    joint &= np.isfinite(times[0]) & np.isfinite(times[1])  # no times, in some results
    time_s = None
    if joint.any():
        time_s = median_effect(*times, joint, _resamples(library, scenes)).estimate()
        time_s = _honest(time_s, "median", facts)
    metrics: dict[str, Estimate] = {}
    means, thresholds = None, list[AtThreshold]()
    for name, metric in facts.metrics.items():
        if (both := pairs.metric(name)) is None:
            continue
        full = np.asarray(np.isfinite(both[0] + both[1]).all(axis=1))
        if not (n_scenes := int(full.sum())):
            continue
        # A scene in which a trial has no value is left out.
        new, old = (values[full] for values in both)
        drawn = _resamples(library, n_scenes)
        difference = mean_effect(new, old, drawn, metric.unit)
        metrics[name] = _honest(difference.estimate(), "mean", facts)
        if name == question.metric:
            means = float(old.mean()), float(new.mean())
            crashed = [ended[full] for ended in pairs.ended(Status.CRASH)]
            thresholds = [
                _at_threshold(at, metric, (new, old), crashed, facts)
                for at in sorted(set(question.thresholds))
            ]
    return Secondary(
        condition=condition,
        time_s=time_s,
        joint_successes=int(joint.sum()),
        metrics=metrics,
        metric_means=means,
        thresholds=tuple(thresholds),
    )


@lru_cache(maxsize=2)
def _resamples(label: str, scenes: int) -> Resamples:
    return Resamples.draw(label, scenes)


def _honest(estimate: Estimate, what: str, facts: ComparisonFacts) -> Estimate:
    """Return an estimate without the interval that it cannot have: those of a sequential audit need
    a fixed number of scenes."""
    if facts.order is not None:
        why = f"{what} of the scenes until the audit stopped: no interval"
    elif estimate.n_scenes < MIN_SCENES:
        why = f"{what} of {estimate.n_scenes} scenes, too few for an interval"
    elif estimate.low == estimate.high:
        why = f"{what} of {estimate.n_scenes} scenes that hardly differ: no interval"
    else:
        return estimate
    return estimate.model_copy(update={"low": None, "high": None, "method": why})


def _at_threshold(
    threshold: float,
    of: Metric,
    values: Sequence[Floats],
    crashed: Sequence[Bools],
    facts: ComparisonFacts,
) -> AtThreshold:
    less = of.better == "less"
    new, old = (
        ~crash & (metric <= threshold if less else metric >= threshold)
        for metric, crash in zip(values, crashed, strict=True)
    )
    sequential = facts.order is not None
    difference = success_effect(new, old, sequential=sequential)
    return AtThreshold(
        threshold=threshold,
        baseline_percent=percent(old.astype(np.float64)),
        repair_percent=percent(new.astype(np.float64)),
        difference=difference.estimate(),
    )
