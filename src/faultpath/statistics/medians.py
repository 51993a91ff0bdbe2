"""Medians of paired differences, for completion times on jointly successful scenes."""

import numpy as np
from numpy.typing import NDArray

from faultpath.statistics.contrast import Contrast, check_scenes
from faultpath.statistics.inputs import Floats, Numbers, by_scene_and_seed
from faultpath.statistics.resamples import Resamples


def median_effect(
    first: Numbers, second: Numbers, joint: Numbers, resamples: Resamples, unit: str = "s"
) -> Contrast:
    """Return the median over scenes of the within-scene difference, where both arms count.

    ``first``, ``second`` and ``joint`` are [scenes, seeds] (or [scenes]); ``joint`` is true where
    both arms succeeded, and the arms' entries elsewhere are not read. Differences are averaged
    over the joint seeds of a scene. Whole scenes are resampled, so the number of jointly
    successful scenes varies between resamples, as it would between new libraries; the few
    resamples without any are left out. ``n_scenes`` counts the jointly successful scenes.
    """
    mask = np.asarray(joint, dtype=np.bool_)
    mask = mask[:, np.newaxis] if mask.ndim == 1 else mask
    difference = _masked(first, mask, "first") - _masked(second, mask, "second")
    check_scenes(len(difference), resamples)
    used = mask.any(axis=1)
    if not used.any():
        raise ValueError("no scene is jointly successful, so there is no median difference")
    means = difference[used].sum(axis=1) / mask[used].sum(axis=1)
    return Contrast(
        value=float(np.median(means)),
        draws=_resampled_medians(means, np.flatnonzero(used), resamples),
        per_seed=tuple(
            float(np.median(column[seen]))
            for column, seen in zip(difference.T, mask.T, strict=True)
            if seen.any()
        ),
        unit=unit,
        method="median of paired differences, percentile bootstrap of scenes",
        n_scenes=int(used.sum()),
        n_seeds=mask.shape[1],
        resamples=resamples,
    )


def _masked(values: Numbers, mask: NDArray[np.bool_], name: str) -> Floats:
    array = np.asarray(values, dtype=np.float64)
    array = array[:, np.newaxis] if array.ndim == 1 else array
    if array.shape != mask.shape:
        raise ValueError(f"{name} has shape {array.shape}, joint has {mask.shape}")
    return by_scene_and_seed(np.where(mask, array, 0.0), name)


def _resampled_medians(values: Floats, scenes: NDArray[np.intp], resamples: Resamples) -> Floats:
    """Return the median of ``values``, which belong to ``scenes``, in every resample with any."""
    order = np.argsort(values, kind="stable")
    ordered, columns = values[order], scenes[order]
    return np.concatenate([_medians(ordered, block[:, columns]) for block in resamples.blocks()])


def _medians(ordered: Floats, counts: Floats) -> Floats:
    """Return the median of ascending values [n] that occur ``counts`` [resamples, n] times."""
    reached = np.cumsum(counts, axis=1, dtype=np.int32)
    reached = reached[reached[:, -1] > 0]
    total = reached[:, -1:]
    # The middle one, or the two middle ones, of the resampled values in ascending order.
    lower = (2 * reached < total).sum(axis=1)
    upper = (2 * reached <= total).sum(axis=1)
    return (ordered[lower] + ordered[upper]) / 2.0
