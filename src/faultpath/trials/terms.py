"""What a system may say of why its errors add up or cancel: two of them, on one scale.

It is for pictures only: no trial reads it, and no audit needs it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

Values: TypeAlias = NDArray[np.float64]


class Recorded(Protocol):
    """What was recorded of one trial, `[T, P]`: a row a control step, not a number where nothing
    was read. `KeyError` for what the variant has not got."""

    def held(self, source: str) -> Values:
        """What a source held."""
        ...

    def got(self, channel: str, consumer: str) -> Values:
        """What a tap delivered, faults included."""
        ...


@dataclass(frozen=True)
class ErrorTerm:
    """The error of one module, believed minus true."""

    words: str
    """The module, and what it has wrong: `controller: gain`."""
    of: Callable[[Recorded], Values]
    """Takes it from a trial, a number a step; a pure function."""


@dataclass(frozen=True)
class ErrorSum:
    """Two errors that act together: what the system feels is their sum.

    A system that knows of such has one as its attribute `errors`.
    """

    words: str
    """What they are errors of: `error of the expected acceleration`."""
    unit: str
    terms: tuple[ErrorTerm, ErrorTerm]
