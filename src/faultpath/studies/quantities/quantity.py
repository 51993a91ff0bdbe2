"""What a quantity is: a contrast worked out of a run; tables print it, claims are decided by it."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from faultpath.statistics import Contrast
from faultpath.studies.results import Results


class Undecidable(Exception):
    """The run holds everything that was asked for, and yet nothing that decides."""


Quantity = Callable[[Results], Contrast]
"""Works a quantity out; raises `NotRun` or `Undecidable`."""


def decisive(contrast: Contrast, notable: float | None = None) -> Contrast:
    """Return a contrast without its interval where too few scenes give it.

    `notable` as in `Contrast`.
    """
    if contrast.enough:
        return replace(contrast, notable=notable)
    return replace(contrast, notable=notable, draws=np.empty(0), scenes=None)
