"""Interventions on clocks: a delay that changes from step to step, and one that grows."""

from abc import abstractmethod
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from faultpath.arrays import Array, copy, namespace, pick, place
from faultpath.faults.base import Intervention, Memory, Moment


class _Late(Intervention):
    """Deliver an older reading, older by a whole number of steps of each scene's own."""

    @abstractmethod
    def _steps(self, reading: Array, at: Moment) -> Any:
        """Return how old the reading may be: an int, or an int array `[B]` beside the reading."""

    @abstractmethod
    def _longest(self, at: Moment) -> int | None:
        """Return the greatest age at any later step; `None` where the host cannot tell."""

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return an empty past, and that nothing was delivered yet."""
        return (), None

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the newest reading of at least that age; never one older than the one before."""
        past, newest = memory
        past = (*past, (at.step, copy(reading)))
        longest = self._longest(at)
        while longest is not None and len(past) > 1 and past[1][0] <= at.step - longest:
            past = past[1:]
        wanted = at.step - self._steps(reading, at)
        if newest is not None:
            wanted = _later(wanted, newest)
        value = past[0][1]
        for step, held in past[1:]:
            value = pick(step <= wanted, held, value)
        return value, (past, wanted)


def _later(one: Any, other: Any) -> Any:
    if isinstance(one, int) and isinstance(other, int):
        return max(one, other)
    zero = 0 * (other if isinstance(one, int) else one)
    return namespace(zero).where(one > other, one + zero, other + zero)


class Jitter(_Late):
    """Deliver readings late by a number of steps drawn anew at each, in their order.

    A reading that overtakes an older one makes the older one lost.
    """

    kind: Literal["jitter"] = "jitter"
    said = "delayed by 0 to {steps} steps, drawn at each step"
    value_field: ClassVar[str | None] = "steps"
    random: ClassVar[bool] = True
    steps: int = Field(ge=0)
    """Greatest delay; every delay from 0 to this is as likely."""

    def _steps(self, reading: Array, at: Moment) -> Any:
        drawn = np.floor(at.draws.uniform((), at.step) * (self.steps + 1)).astype(np.int64)
        late = place(drawn, reading)
        if isinstance(at.elapsed, int):
            return 0 if at.elapsed < 0 else late
        return namespace(late).where(at.elapsed < 0, 0 * late, late)

    def _longest(self, at: Moment) -> int | None:
        return self.steps


class Skew(_Late):
    """Deliver readings by a clock that runs slow since the onset, so that they age steadily."""

    kind: Literal["skew"] = "skew"
    said = "by a clock that loses {rate} s in a second"
    value_field: ClassVar[str | None] = "rate"
    rate: float = Field(ge=0, le=1)
    """Seconds of age gained in a second."""

    def _steps(self, reading: Array, at: Moment) -> Any:
        if isinstance(at.elapsed, int):
            return int(self.rate * max(at.elapsed, 0))
        xp = namespace(at.elapsed)
        age = self.rate * xp.astype(at.elapsed, xp.float64)
        return xp.astype(xp.floor(xp.clip(age, 0.0, None)), xp.int64)

    def _longest(self, at: Moment) -> int | None:
        return None
