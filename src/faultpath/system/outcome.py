"""Outcome of one trial: its status, and metrics by name."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from numbers import Real
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import StringConstraints

from faultpath.core.results import Frozen
from faultpath.core.text import LARGEST_NUMBER
from faultpath.interface.declaration import Words
from faultpath.system.declared import shown

MetricName = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]*$")]


class Metric(Frozen):
    """A number that every trial of a system has, such as a return or an RMS error."""

    unit: Words
    """`1` for a number without a unit."""
    better: Literal["less", "more"]
    words: Words = ""
    """Its name within a sentence; empty: the metric's name without the unit."""
    title: Words = ""
    """Heading above a picture; empty: its words."""

    def label(self, name: str) -> str:
        """Return its name within a sentence."""
        return self.words or name.removesuffix(f"_{self.unit}").replace("_", " ")


VEHICLE = {
    "terminal_distance_m": Metric(
        unit="m", better="less", words="terminal distance", title="Distance to the goal at the end"
    ),
    "min_clearance_m": Metric(unit="m", better="more", words="least clearance"),
}
"""Metrics of a vehicle that flies to a goal, and of results that name no metrics. Tables hold both
or neither."""


class Status(StrEnum):
    """How a trial ended."""

    SUCCESS = "success"
    CRASH = "crash"
    TIMEOUT = "timeout"
    FAILED = "failed"
    """The program raised an error, hung, died, or gave another result when run again: the trial is
    excluded with every pair it belongs to."""


@dataclass(frozen=True)
class Outcome:
    """The result of one closed-loop trial in one scene.

    The three hashes are of the initial state, the disturbances and the planner's noise. Two trials
    are a pair only if all three agree. Where there is nothing to hash, as without a random planner,
    the text is `none`: an empty one proves nothing and is refused.
    """

    scene: str
    status: Status
    time_s: float
    """Time at which the trial ended, above zero: the time to the goal for a success."""
    initial_hash: str
    disturbance_hash: str
    planner_noise_hash: str
    metrics: Mapping[str, float | None] = field(default_factory=dict[str, float | None])
    """Other measurements, by name, as the system's `metrics` declare it."""
    faulted_steps: int = 0
    """Control steps with a fault in force at one or more taps that delivered."""
    altered_steps: int = 0
    """Control steps at which a reader got another value than the reading."""
    error: str | None = None
    trace: NDArray[np.float32] | None = None
    """Position at each control step, `[T, 3]`, metres, world frame."""
    trajectory_hash: str = ""
    """Hash of all values that its readers got while it ran; empty for other tools' trials."""

    @property
    def met(self) -> tuple[str, tuple[str, ...]]:
        """The scene, and the hashes of the trial's conditions there."""
        return self.scene, (self.initial_hash, self.disturbance_hash, self.planner_noise_hash)

    @property
    def failed(self) -> bool:
        """Whether the program failed, so that the trial has no outcome."""
        return self.status is Status.FAILED

    def steps(self, dt_s: float) -> int:
        """Return its number of control steps of `dt_s`."""
        return control_steps(self.time_s, dt_s)


def control_steps(time_s: float, dt_s: float) -> int:
    """Return the number of control steps in a time that is a rounded sum of them."""
    return math.ceil(time_s / dt_s - 1e-6)


_LONGEST_ERROR = 2000


def failed_outcome(scene: str, error: object) -> Outcome:
    """Return the outcome of a trial in which the program failed."""
    return Outcome(scene, Status.FAILED, 0.0, "", "", "", error=_text(error))


def _text(error: object) -> str:
    return str(error).encode(errors="backslashreplace").decode()[:_LONGEST_ERROR]


class _Malformed(Exception):
    pass


def checked(outcome: Outcome, metrics: Collection[str] = ()) -> Outcome:
    """Return a system's outcome of one trial with plain numbers and a trace in float32.

    A malformed outcome (a number that is not finite, an unknown status, a metric that is not among
    the declared `metrics`, a trace that is no `[T, 3]`) makes the trial failed; its error says what
    is wrong.
    """
    status: Any = outcome.status
    if status is Status.FAILED:
        return failed_outcome(outcome.scene, outcome.error or "the system said that it failed")
    try:
        if not isinstance(status, Status):
            raise _Malformed(f"status is {shown(status)}: give a faultpath.system.Status")
        time_s = _number("time_s", outcome.time_s)
        if time_s <= 0:
            raise _Malformed(f"time_s is {time_s}: a trial takes at least one control step")
        if odd := [name for name in outcome.metrics if name not in metrics]:
            raise _Malformed(
                f"metric {shown(odd[0])} is not declared: name it in the system's `metrics`"
            )
        for name in ("initial_hash", "disturbance_hash", "planner_noise_hash"):
            value: Any = getattr(outcome, name)
            if not isinstance(value, str) or _text(value) != value[:_LONGEST_ERROR]:
                raise _Malformed(f"{name} is {shown(value)}: give text")
            if not value:
                raise _Malformed(
                    f"{name} is empty and proves no pairing: give a hash, or the word none"
                )
        return replace(
            outcome,
            time_s=time_s,
            metrics={k: _number(k, v) for k, v in outcome.metrics.items() if v is not None},
            faulted_steps=0,
            altered_steps=0,
            trajectory_hash="",
            error=None if outcome.error is None else _text(outcome.error),
            trace=None if outcome.trace is None else _positions(outcome.trace),
        )
    except _Malformed as error:
        return failed_outcome(outcome.scene, f"malformed outcome: {error}")


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        raise _Malformed(f"{name} is {shown(value)}: give a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not abs(number) <= LARGEST_NUMBER:
        raise _Malformed(f"{name} is {number}: give a finite number of at most {LARGEST_NUMBER:g}")
    return number


def _positions(trace: Any) -> NDArray[np.float32]:
    try:
        with np.errstate(over="ignore"):  # what overflows is not finite, and refused below
            positions = np.asarray(trace, dtype=np.float32)
    except (TypeError, ValueError, RuntimeError):
        raise _Malformed("trace is no array of numbers") from None
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise _Malformed(f"trace has the shape {list(positions.shape)}, not [steps, 3]")
    wrong = np.flatnonzero(~np.isfinite(positions).all(axis=1))
    if wrong.size:
        raise _Malformed(f"trace is not finite at step {wrong[0]}")
    return positions
