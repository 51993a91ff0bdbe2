"""Checks of arrays; a wrong one is a programming error, hence ValueError."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.bool_ | np.integer[Any] | np.floating[Any]]
Floats = NDArray[np.float64]


def by_scene_and_seed(values: Numbers, name: str = "values", *, binary: bool = False) -> Floats:
    """Return ``values`` ([scenes, seeds], or [scenes] for one seed) as float64 [scenes, seeds].

    ``binary`` values are 0 and 1, and NaN where a trial has no outcome.
    """
    array = np.asarray(values, dtype=np.float64)
    array = array[:, np.newaxis] if array.ndim == 1 else array
    if array.ndim != 2:
        raise ValueError(f"{name} must be [scenes, seeds] or [scenes], not {array.ndim}-d")
    if array.size == 0:
        raise ValueError(f"{name} holds no outcomes: its shape is {array.shape}")
    if binary:
        if not ((array == 0.0) | (array == 1.0) | np.isnan(array)).all():
            raise ValueError(f"{name} must hold only 0 and 1 (or booleans), or NaN for no outcome")
    elif not np.isfinite(array).all():
        raise ValueError(f"{name} holds NaN or infinity; leave such trials out before")
    return array


def paired(first: Numbers, second: Numbers, *, binary: bool = False) -> tuple[Floats, Floats]:
    """Return both variants as float64 [scenes, seeds]; `ValueError` for different shapes."""
    one = by_scene_and_seed(first, "first", binary=binary)
    two = by_scene_and_seed(second, "second", binary=binary)
    if one.shape != two.shape:
        raise ValueError(f"paired outcomes need one shape, got {one.shape} and {two.shape}")
    return one, two
