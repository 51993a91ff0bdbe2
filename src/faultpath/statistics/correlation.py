"""Rank correlation over a handful of cells (paper, mechanism section: nine cells)."""

import numpy as np

from faultpath.statistics.estimate import Correlation
from faultpath.statistics.inputs import Floats, Numbers, by_scene_and_seed

SMALL_N = 20


def spearman(x: Numbers, y: Numbers) -> Correlation:
    """Return Spearman's rank correlation of two [n] arrays; no p-value, cells are not a sample."""
    one, two = by_scene_and_seed(x, "x")[:, 0], by_scene_and_seed(y, "y")[:, 0]
    if np.ndim(x) != 1 or np.ndim(y) != 1 or len(one) != len(two) or len(one) < 2:
        raise ValueError(f"need two [n] arrays with n >= 2, got {np.shape(x)} and {np.shape(y)}")
    n = len(one)
    if np.ptp(one) == 0.0 or np.ptp(two) == 0.0:
        return Correlation(value=None, n=n, note="one side is constant, so ranks do not order it")
    value = float(np.corrcoef(_ranks(one), _ranks(two))[0, 1])
    note = f"descriptive: {n} cells that share scenes and models" if n < SMALL_N else None
    return Correlation(value=min(1.0, max(-1.0, value)), n=n, note=note)


def _ranks(values: Floats) -> Floats:
    """Return ranks from 1; equal values share their mean rank."""
    _, place, times = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(times) - (times - 1) / 2.0)[place]
