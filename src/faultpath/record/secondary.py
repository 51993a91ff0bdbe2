"""Secondary outcomes of a path: time, distance and clearance. Nothing is decided from them."""

from typing import NamedTuple

from faultpath.statistics import Estimate, Resamples, fewest_scenes, mean_effect, median_effect
from faultpath.trials.pairing import Bools, Floats, Pairs

MIN_SCENES = fewest_scenes(1)
"""Fewer scenes than this cannot give a two-sided 95 % interval of a median: 2 / 2^5 > 0.05."""


class Secondary(NamedTuple):
    """The repair minus the baseline, for new scenes and the seeds that were run."""

    time_s: Estimate | None
    """On jointly successful scenes; `None` without one."""
    joint_successes: int
    terminal_distance_m: Estimate | None
    min_clearance_m: Estimate | None


def secondary(pairs: Pairs, resamples: Resamples) -> Secondary:
    """Return the secondary outcomes of paired trials."""
    first, second = pairs.first, pairs.second
    joint = first.success & second.success
    return Secondary(
        time_s=_time(pairs, joint, resamples),
        joint_successes=int(joint.sum()),
        terminal_distance_m=_mean(first.terminal_distance_m, second.terminal_distance_m, resamples),
        min_clearance_m=_mean(first.min_clearance_m, second.min_clearance_m, resamples),
    )


def _time(pairs: Pairs, joint: Bools, resamples: Resamples) -> Estimate | None:
    if not joint.any():
        return None
    effect = median_effect(pairs.first.time_s, pairs.second.time_s, joint, resamples)
    return _honest(effect.estimate(), "median")


def _mean(first: Floats | None, second: Floats | None, resamples: Resamples) -> Estimate | None:
    if first is None or second is None:
        return None
    return _honest(mean_effect(first, second, resamples, "m").estimate(), "mean")


def _honest(estimate: Estimate, what: str) -> Estimate:
    """Return the estimate without its interval where resampling cannot give one."""
    if estimate.n_scenes < MIN_SCENES:
        why = f"{what} of {estimate.n_scenes} scenes, too few for an interval"
    elif estimate.low == estimate.high:
        why = f"{what} of {estimate.n_scenes} scenes that hardly differ: no interval"
    else:
        return estimate
    return estimate.model_copy(update={"low": None, "high": None, "method": why})
