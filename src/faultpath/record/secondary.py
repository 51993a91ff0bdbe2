"""Secondary outcomes of a path: time and metrics. Nothing is decided from them."""

from collections.abc import Mapping
from typing import NamedTuple

from faultpath.statistics import Estimate, Resamples, fewest_scenes, mean_effect, median_effect
from faultpath.trials.metrics import Metric
from faultpath.trials.pairing import Bools, Floats, Pairs

MIN_SCENES = fewest_scenes(1)
"""Fewer scenes than this cannot give a two-sided 95 % interval of a median: 2 / 2^5 > 0.05."""


class Secondary(NamedTuple):
    """The repair minus the baseline, for new scenes and the seeds that were run."""

    time_s: Estimate | None
    """On jointly successful scenes; `None` without one."""
    joint_successes: int
    metrics: dict[str, Estimate]


def secondary(pairs: Pairs, resamples: Resamples, metrics: Mapping[str, Metric]) -> Secondary:
    """Return the secondary outcomes of paired trials."""
    first, second = pairs.first, pairs.second
    joint = first.success & second.success
    return Secondary(
        time_s=_time(pairs, joint, resamples),
        joint_successes=int(joint.sum()),
        metrics={
            name: _mean(first.metrics[name], second.metrics[name], resamples, metric.unit)
            for name, metric in metrics.items()
            if name in first.metrics and name in second.metrics
        },
    )


def _time(pairs: Pairs, joint: Bools, resamples: Resamples) -> Estimate | None:
    if not joint.any():
        return None
    effect = median_effect(pairs.first.time_s, pairs.second.time_s, joint, resamples)
    return _honest(effect.estimate(), "median")


def _mean(first: Floats, second: Floats, resamples: Resamples, unit: str) -> Estimate:
    return _honest(mean_effect(first, second, resamples, unit).estimate(), "mean")


def _honest(estimate: Estimate, what: str) -> Estimate:
    """Return the estimate without its interval where resampling cannot give one."""
    if estimate.n_scenes < MIN_SCENES:
        why = f"{what} of {estimate.n_scenes} scenes, too few for an interval"
    elif estimate.low == estimate.high:
        why = f"{what} of {estimate.n_scenes} scenes that hardly differ: no interval"
    else:
        return estimate
    return estimate.model_copy(update={"low": None, "high": None, "method": why})
