"""One fault at one tap: its window, its memory, and what it makes of a reading."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from faultpath.core.arrays import Array, namespace, pick, place, rows
from faultpath.core.errors import UserError
from faultpath.faults import Draws, Fault, Moment, Phases
from faultpath.faults.base import Memory
from faultpath.loop.taps.tally import Tally

_PHASES = -1
"""Part of the draws that says when an intermittent fault is on; the others are of the value."""


class Strike:
    """A resolved fault as it acts on the deliveries of one tap."""

    __slots__ = ("_draws", "_dt_s", "_memories", "_phases", "_window", "fault", "in_force")

    def __init__(self, fault: Fault, draws: Draws, dt_s: float) -> None:
        self.fault = fault
        self.in_force = Tally()
        self._window = fault.window
        self._draws = draws
        self._dt_s = dt_s
        self._phases: Phases | None = None
        if fault.intermittence is not None:
            onsets = self.onsets(len(draws.scenes))
            chance = draws.part(_PHASES)
            self._phases = Phases.of(fault.intermittence, onsets, dt_s, chance)
        self._memories: dict[int, Memory] = {}
        """By ask within a step; a reading that is no query is ask 0."""

    def act(self, reading: Array, step: int, ask: int = 0) -> tuple[Array, Any]:
        """Return the value and whether the fault is in force: a bool or a bool array `[B]`.

        Raises `UserError` where the intervention cannot act on such a reading.
        """
        if self._window.over(step):
            self._memories.clear()
            return reading, False
        elapsed: Any = step - self._window.onset
        weight: Any = self._window.weight(step)
        if self._phases is not None:
            elapsed = place(self._phases.elapsed(step), reading)
            weight = weight * namespace(elapsed).astype(elapsed >= 0, namespace(elapsed).float64)
        at = Moment(step, elapsed, self._dt_s, self._draws.of_ask(ask))
        doing = self.fault.intervention
        if ask not in self._memories:
            self._memories[ask] = doing.begin(reading, at)
        value, self._memories[ask] = doing.apply(reading, self._memories[ask], at)
        if value is not reading and (value.dtype != reading.dtype or value.shape != reading.shape):
            raise self._unfit(
                f"turns {reading.dtype} {list(reading.shape)} into {value.dtype} "
                f"{list(value.shape)}; choose one that keeps them"
            )
        return self._blend(reading, value, weight), weight > 0

    def _blend(self, reading: Array, value: Array, weight: Any) -> Array:
        if isinstance(weight, float):
            if weight in (0.0, 1.0):
                return value if weight else reading
            self._check_blends(reading)
            return reading + (value - reading) * weight
        if not self.fault.recovery_steps:
            return pick(weight > 0, value, reading)
        self._check_blends(reading)
        share = rows(namespace(weight).astype(weight, reading.dtype), reading)
        mixed = reading + (value - reading) * share
        return pick(weight >= 1, value, pick(weight > 0, mixed, reading))

    def _check_blends(self, reading: Array) -> None:
        if not namespace(reading).isdtype(reading.dtype, "real floating"):
            raise self._unfit(f"cannot recover step by step in {reading.dtype}; leave recovery out")

    def _unfit(self, said: str) -> UserError:
        return UserError(
            f"fault on channel '{self.fault.channel}': {self.fault.intervention.kind} {said}"
        )

    def onsets(self, n_scenes: int) -> NDArray[np.int64]:
        """Return the first step in force, `[B]`."""
        return np.full(n_scenes, self._window.onset, dtype=np.int64)
