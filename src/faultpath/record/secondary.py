"""Secondary outcomes of a path: time and metrics. Nothing is decided from them."""

from typing import NamedTuple

from faultpath.record.family import percent
from faultpath.record.model import AtThreshold
from faultpath.record.question import Question
from faultpath.statistics import (
    Estimate,
    Resamples,
    fewest_scenes,
    mean_effect,
    median_effect,
    success_effect,
)
from faultpath.trials.pairing import Bools, Floats, Pairs, Trials

MIN_SCENES = fewest_scenes()
"""Fewer scenes than this cannot give a two-sided 95 % interval of a median: 2 / 2^5 > 0.05."""


class Secondary(NamedTuple):
    """The repair minus the baseline, for new scenes and the seeds that were run."""

    time_s: Estimate | None
    """On jointly successful scenes; `None` without one."""
    joint_successes: int
    metrics: dict[str, Estimate]
    metric_means: tuple[float, float] | None
    thresholds: tuple[AtThreshold, ...]


def secondary(pairs: Pairs, resamples: Resamples, asked: Question) -> Secondary:
    """Return the secondary outcomes of paired trials.

    Of a sequential audit time and metrics have no interval: theirs need a fixed number of scenes.
    """
    first, second = pairs.first, pairs.second
    joint = first.success & second.success
    found = Secondary(
        time_s=_time(pairs, joint, resamples),
        joint_successes=int(joint.sum()),
        metrics={
            name: _mean(first.metrics[name], second.metrics[name], resamples, metric.unit)
            for name, metric in asked.metrics.items()
            if name in first.metrics and name in second.metrics
        },
        metric_means=_means(pairs, asked.metric),
        thresholds=tuple(_at(pairs, asked, each, resamples) for each in asked.thresholds)
        if _means(pairs, asked.metric)
        else (),
    )
    if asked.stop is None:
        return found
    return found._replace(
        time_s=found.time_s and _bare(found.time_s, "median"),
        metrics={name: _bare(each, "mean") for name, each in found.metrics.items()},
    )


def _bare(estimate: Estimate, what: str) -> Estimate:
    method = f"{what} of the scenes until the audit stopped: no interval"
    return estimate.model_copy(update={"low": None, "high": None, "method": method})


def _means(pairs: Pairs, metric: str) -> tuple[float, float] | None:
    repair, baseline = (side.metrics.get(metric) for side in (pairs.first, pairs.second))
    if repair is None or baseline is None:
        return None
    return float(baseline.mean()), float(repair.mean())


def _at(pairs: Pairs, asked: Question, threshold: float, resamples: Resamples) -> AtThreshold:
    less = asked.metrics[asked.metric].better == "less"

    def reached(side: Trials) -> Bools:
        value = side.metrics[asked.metric]
        return ~side.crash & (value <= threshold if less else value >= threshold)

    repair, baseline = reached(pairs.first), reached(pairs.second)
    return AtThreshold(
        threshold=threshold,
        baseline_percent=percent(baseline),
        repair_percent=percent(repair),
        difference=success_effect(
            repair,
            baseline,
            resamples,
            sequential=asked.stop is not None,
            rule=asked.rule,
        ).estimate(),
    )


def _time(pairs: Pairs, joint: Bools, resamples: Resamples) -> Estimate | None:
    if not joint.any():
        return None
    effect = median_effect(pairs.first.time_s, pairs.second.time_s, joint, resamples)
    return _honest(effect.estimate(), "median")


def _mean(first: Floats, second: Floats, resamples: Resamples, unit: str) -> Estimate:
    return _honest(mean_effect(first, second, resamples, unit).estimate(), "mean")


def _honest(estimate: Estimate, what: str) -> Estimate:
    if estimate.n_scenes < MIN_SCENES:
        why = f"{what} of {estimate.n_scenes} scenes, too few for an interval"
    elif estimate.low == estimate.high:
        why = f"{what} of {estimate.n_scenes} scenes that hardly differ: no interval"
    else:
        return estimate
    return estimate.model_copy(update={"low": None, "high": None, "method": why})
