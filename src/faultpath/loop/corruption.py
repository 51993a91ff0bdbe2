"""Faults as they act on the deliveries of taps."""

from collections.abc import Iterable, Iterator
from typing import Any

from faultpath.core.arrays import Array, Inexact, like, namespace, to_numpy
from faultpath.core.errors import UserError
from faultpath.faults import Draws, Fault, Moment
from faultpath.faults.base import Memory
from faultpath.loop.delivery_log import StepCounter


class Corruption:
    """A resolved fault as it acts on the deliveries of one tap."""

    __slots__ = ("_draws", "_dt_s", "_first_dtype", "_memories", "fault", "in_force")

    def __init__(self, fault: Fault, draws: Draws, dt_s: float) -> None:
        self.fault = fault
        self.in_force = StepCounter()
        self._draws = draws
        self._dt_s = dt_s
        self._first_dtype: Any = None
        self._memories: dict[int, Memory] = {}
        """By request within a step; a reading that is no query counts as request 0."""

    def apply(self, reading: Array, step: int, request: int = 0) -> tuple[Array, bool]:
        """Return the value, and whether the fault is in force.

        Raises `UserError` where the intervention cannot act on such a reading.
        """
        fault, intervention = self.fault, self.fault.intervention
        if fault.over(step):
            self._memories.clear()
            return reading, False
        draws = self._draws.beside(f"?{request}") if request else self._draws
        moment = Moment(step, step - fault.onset_step, self._dt_s, draws)
        if self._first_dtype is None:
            self._first_dtype = reading.dtype
        try:
            if request not in self._memories:
                self._memories[request] = intervention.begin(reading, moment)
            value, self._memories[request] = intervention.apply(
                reading, self._memories[request], moment
            )
            if value.dtype != reading.dtype and value.dtype == self._first_dtype:
                # Held since before the source had its type, as `before=0.0` of whole numbers is.
                value = like(to_numpy(value), reading)
        except Inexact:
            raise self._changes_type(reading, "fractions") from None
        if value is not reading and (value.dtype != reading.dtype or value.shape != reading.shape):
            raise self._changes_type(reading, f"{value.dtype} {list(value.shape)}")
        weight = fault.weight(step)
        if weight in (0.0, 1.0):
            return (value, True) if weight else (reading, False)
        if not fractional(reading):
            raise UserError(
                f"{self._prefix} cannot recover step by step in {reading.dtype}; leave recovery out"
            )
        return reading + (value - reading) * weight, True

    def _changes_type(self, reading: Array, value: str) -> UserError:
        """Return the error for a value that is not like the reading."""
        advice = "choose one that keeps them"
        if not fractional(reading):
            advice += ", or let the source give real numbers: 1.0 in place of 1"
        return UserError(
            f"{self._prefix} turns {reading.dtype} {list(reading.shape)} into {value}; {advice}"
        )

    @property
    def _prefix(self) -> str:
        return f"fault on channel '{self.fault.channel}': {self.fault.intervention.kind}"


def corruptions(
    faults: Iterable[Fault], scenes: tuple[str, ...], dt_s: float, seed: int
) -> Iterator[tuple[str, Corruption]]:
    """Yield each reader that a fault names, and the fault as it acts there.

    Raises `UserError` for faults that are to be correlated and draw the same numbers.
    """
    # One object for equal draws, so that numbers are drawn once for all readers.
    shared: dict[Draws, Draws] = {}
    loaded: dict[Draws | None, Fault] = {}
    for fault in faults:
        draws = fault.draws(scenes, seed)
        if abs(fault.loading) < 1:
            if draws.own in loaded:
                raise UserError(
                    f"faults '{loaded[draws.own].describe()}' and '{fault.describe()}' have "
                    "a loading and draw the same numbers nevertheless: give them different "
                    "causes"
                )
            loaded[draws.own] = fault
        draws = shared.setdefault(draws, draws)
        for reader in fault.readers:
            yield reader, Corruption(fault, draws, dt_s)


def fractional(value: Array) -> bool:
    """Return whether an array holds real numbers, not whole ones or truths."""
    return bool(namespace(value).isdtype(value.dtype, "real floating"))
