"""Descriptive numbers of a path, which decide nothing: how trials ended, times, metrics."""

from collections.abc import Sequence
from functools import lru_cache
from math import isfinite
from statistics import median
from typing import Any

import numpy as np

from faultpath.decisions.model import CORRECT, ArmCounts, AtThreshold, Path
from faultpath.decisions.question import Question
from faultpath.statistics.contrast import MIN_SCENES
from faultpath.statistics.effects import mean_effect, median_effect, seed_sums, success_effect
from faultpath.statistics.estimate import Estimate
from faultpath.statistics.inputs import Floats
from faultpath.statistics.resamples import Resamples
from faultpath.trials.outcome import Status
from faultpath.trials.pairing import Pairs, Trials
from faultpath.trials.table import OutcomeTable


def percent(success: Floats) -> float:
    """Return success `[scenes, seeds]` in percent, over scenes; NaN where a pair did not run."""
    ran = success[~np.isnan(success).all(axis=1)]
    return 100.0 * float(seed_sums(ran).sum()) / ran.size


def cells_of(
    question: Question, paths: Sequence[Path], table: OutcomeTable
) -> tuple[ArmCounts, ...]:
    """Return how the trials of both arms ended on every path."""
    cells: list[ArmCounts] = []
    for path in paths:
        for variant in (question.baseline, question.repair):
            seeds = table.seeds(variant, path.name)
            ends = [r.outcome for seed in seeds for r in table.arm(variant, path.name, seed)]
            count = {status: sum(end.status is status for end in ends) for status in Status}
            ran = len(ends) - count[Status.FAILED]
            times = [e.time_s for e in ends if e.status is Status.SUCCESS and isfinite(e.time_s)]
            cells.append(
                ArmCounts(
                    variant=variant,
                    path=path.name,
                    trials=len(ends),
                    success=count[Status.SUCCESS],
                    crash=count[Status.CRASH],
                    timeout=count[Status.TIMEOUT],
                    failed=count[Status.FAILED],
                    success_percent=100 * count[Status.SUCCESS] / ran if ran else 0.0,
                    median_time_s=median(times) if times else None,
                    faulted_trials=sum(end.faulted_steps > 0 for end in ends),
                    altered_trials=sum(end.altered_steps > 0 for end in ends),
                )
            )
    return tuple(cells)


def untested_paths(paths: Sequence[Path], cells: Sequence[ArmCounts]) -> tuple[str, ...]:
    """Return the paths on which the fault changed nothing in any trial."""
    acted = {cell.path for cell in cells if cell.altered_trials}
    return tuple(path.name for path in paths if path.name != CORRECT and path.name not in acted)


def secondary(pairs: Pairs, question: Question) -> dict[str, Any]:
    """Return the fields of an `Effect` on time and metrics, over the scenes of which every seed has
    both outcomes, for new scenes and the seeds run."""
    if not pairs.scenes:
        return {"time_s": None, "joint_successes": 0, "metrics": {}}
    first, second = pairs.first, pairs.second
    library, scenes = question.library_hash, len(pairs.scenes)
    joint = first.success & second.success
    joint &= np.isfinite(first.time_s) & np.isfinite(second.time_s)  # no times, in some results
    time_s = None
    if joint.any():
        drawn = _resamples(library, scenes)
        time_s = median_effect(first.time_s, second.time_s, joint, drawn).estimate()
        time_s = _honest(time_s, "median", question)
    metrics: dict[str, Estimate] = {}
    means, thresholds = None, list[AtThreshold]()
    for name, metric in question.metrics.items():
        if name not in first.metrics or name not in second.metrics:
            continue
        full = np.asarray(np.isfinite(first.metrics[name] + second.metrics[name]).all(axis=1))
        if not (n_scenes := int(full.sum())):
            continue
        # Of a scene in which a trial has no value nothing is told.
        baseline, repair, drawn = second.only(full), first.only(full), _resamples(library, n_scenes)
        values = baseline.metrics[name], repair.metrics[name]
        difference = mean_effect(values[1], values[0], drawn, metric.unit)
        metrics[name] = _honest(difference.estimate(), "mean", question)
        if name == question.metric:
            means = float(values[0].mean()), float(values[1].mean())
            thresholds = [
                _at_threshold(at, baseline, repair, drawn, question) for at in question.thresholds
            ]
    return {
        "time_s": time_s,
        "joint_successes": int(joint.sum()),
        "metrics": metrics,
        "metric_means": means,
        "thresholds": tuple(thresholds),
    }


@lru_cache(maxsize=2)
def _resamples(label: str, scenes: int) -> Resamples:
    return Resamples.draw(label, scenes)


def _honest(estimate: Estimate, what: str, question: Question) -> Estimate:
    """Return an estimate without the interval that it cannot have: those of a sequential audit need
    a fixed number of scenes."""
    if question.stop is not None:
        why = f"{what} of the scenes until the audit stopped: no interval"
    elif estimate.n_scenes < MIN_SCENES:
        why = f"{what} of {estimate.n_scenes} scenes, too few for an interval"
    elif estimate.low == estimate.high:
        why = f"{what} of {estimate.n_scenes} scenes that hardly differ: no interval"
    else:
        return estimate
    return estimate.model_copy(update={"low": None, "high": None, "method": why})


def _at_threshold(
    threshold: float, baseline: Trials, repair: Trials, resamples: Resamples, question: Question
) -> AtThreshold:
    less = question.metrics[question.metric].better == "less"
    old, new = (
        ~arm.crash & (values <= threshold if less else values >= threshold)
        for arm in (baseline, repair)
        for values in [arm.metrics[question.metric]]
    )
    sequential = question.stop is not None
    difference = success_effect(new, old, resamples, sequential=sequential, rule=question.rule)
    return AtThreshold(
        threshold=threshold,
        baseline_percent=percent(old.astype(np.float64)),
        repair_percent=percent(new.astype(np.float64)),
        difference=difference.estimate(),
    )
