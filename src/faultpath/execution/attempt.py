"""One attempt at running an arm over some scenes, and what can come of it."""

import math
import time
import traceback
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from faultpath.blame import described, located
from faultpath.errors import SystemMistake, UserError
from faultpath.taps import Observer, TapCount, Taps
from faultpath.trials.arm import Arm
from faultpath.trials.outcome import Outcome, checked
from faultpath.trials.system import System


class WrongOutcomes(SystemMistake):
    """The system did not return one outcome for each scene, in order."""


@dataclass(frozen=True)
class Done:
    """Every scene has an outcome."""

    outcomes: tuple[Outcome, ...]
    taps: tuple[TapCount, ...]
    seconds: float


@dataclass(frozen=True)
class Raised:
    """The system raised an error, in one scene or another."""

    error: str
    traceback: str


@dataclass(frozen=True)
class Wrong:
    """The audit itself is wrong, whichever scene: no result of it would mean anything."""

    error: Exception


@dataclass(frozen=True)
class Died:
    """The worker process died, or was stopped."""

    how: str
    late: bool = False
    """It was stopped at the time limit: another attempt at the same would take as long."""


Reply = Done | Raised | Wrong | Died


def taps_of(
    system: System,
    arm: Arm,
    scenes: Sequence[str],
    guard: bool = False,
    observer: Observer | None = None,
) -> Taps:
    """Return new taps for an arm over some scenes."""
    variant = system.variants[arm.variant]
    return Taps(
        system.interface,
        arm.faults,
        scenes=tuple(scenes),
        dt_s=system.control_dt_s,
        seed=arm.seed,
        bindings=variant.bindings,
        consumers=variant.consumers,
        privileged=variant.privileged,
        guard=guard,
        observer=observer,
    )


def attempt(
    system: System,
    arm: Arm,
    scenes: Sequence[str],
    guard: bool = False,
    observer: Observer | None = None,
) -> Done | Raised | Wrong:
    """Run an arm over some scenes; an error comes back as a value.

    `guard` and `observer` are those of `Taps`.
    """
    started = time.perf_counter()
    try:
        taps = taps_of(system, arm, scenes, guard, observer)
        outcomes, counts = _run(system, arm, scenes, taps)
    except UserError as error:
        return Wrong(located(error))
    except SystemExit as error:
        return Raised(_exited(error), traceback.format_exc())
    except Exception as error:
        return Raised(_said(error), traceback.format_exc())
    return Done(outcomes, counts, time.perf_counter() - started)


def _exited(error: SystemExit) -> str:
    """Say that a system ended its process; that is an error, whatever the status."""
    return f"the system called sys.exit({error.code!r}): raise an error or return outcomes"


def _said(error: BaseException) -> str:
    text = described(error)
    if isinstance(error, ValueError) and "read-only" in text:
        text += " (what a tap delivers cannot be written to: copy it first)"
    return text


def _run(
    system: System, arm: Arm, scenes: Sequence[str], taps: Taps
) -> tuple[tuple[Outcome, ...], tuple[TapCount, ...]]:
    outcomes = _outcomes(system, scenes, system.run(arm.variant, scenes, taps, arm.seed))
    taps.verify(_last_steps(outcomes, system.control_dt_s))
    receipts = taps.receipts()
    noted = tuple(
        replace(
            outcome,
            struck_steps=int(receipts.steps_struck[i]),
            altered_steps=int(receipts.steps_altered[i]),
        )
        for i, outcome in enumerate(outcomes)
    )
    return noted, receipts.counts()


def _outcomes(system: System, scenes: Sequence[str], returned: object) -> tuple[Outcome, ...]:
    if not isinstance(returned, Iterable):
        raise WrongOutcomes(
            f"run() of system {system.name!r} returned a {type(returned).__name__}: it returns a "
            "list with one Outcome for each scene, in order"
        )
    outcomes: list[Outcome] = []
    for each in cast("Iterable[object]", returned):
        if not isinstance(each, Outcome):
            raise WrongOutcomes(
                f"run() of system {system.name!r} returned a {type(each).__name__} in place of an "
                "Outcome: it returns a list with one Outcome for each scene, in order"
            )
        outcomes.append(each)
    if [outcome.scene for outcome in outcomes] != list(scenes):
        raise WrongOutcomes(
            f"system {system.name!r} was asked for scenes {list(scenes)} and returned outcomes of "
            f"{[outcome.scene for outcome in outcomes]}: run() returns one for each, in order"
        )
    return tuple(checked(outcome, system.metrics) for outcome in outcomes)


def _last_steps(outcomes: Sequence[Outcome], dt_s: float) -> NDArray[np.int64]:
    steps = [0 if o.failed else math.ceil(o.time_s / dt_s - 1e-6) for o in outcomes]
    return np.array(steps, dtype=np.int64) - 1
