"""One attempt at running a treatment over some scenes, and what can come of it."""

import traceback
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

from faultpath.core.error_source import described, located
from faultpath.core.errors import SystemMistake, UserError
from faultpath.loop import DeliveryListener, TapCount, Taps
from faultpath.run.apart import set_apart
from faultpath.run.plan import Treatment
from faultpath.run.work.executor import Failed, Lost
from faultpath.system.outcome import Outcome, checked
from faultpath.system.system import System


@dataclass(frozen=True)
class Done:
    """Every scene has an outcome."""

    outcomes: tuple[Outcome, ...]
    taps: tuple[TapCount, ...]


@dataclass(frozen=True)
class Raised:
    """The system raised an error, in one scene or another."""

    error: str
    traceback: str


Reply = Done | Raised | Failed | Lost
"""`Failed`: the audit itself is wrong, whichever scene, and no result of it would mean anything."""


def taps_of(
    system: System,
    treatment: Treatment,
    scenes: Sequence[str],
    guard: bool = False,
    observer: DeliveryListener | None = None,
) -> Taps:
    """Return new taps for a treatment over some scenes."""
    variant = system.variants[treatment.variant]
    return Taps(
        system.interface,
        treatment.faults,
        scenes=tuple(scenes),
        dt_s=system.control_dt_s,
        seed=treatment.seed,
        bindings=variant.bindings,
        readers=variant.readers,
        privileged=variant.privileged,
        guard=guard,
        observer=observer,
    )


def attempt(
    system: System,
    treatment: Treatment,
    scenes: Sequence[str],
    guard: bool = False,
    observer: DeliveryListener | None = None,
) -> Done | Raised | Failed:
    """Run a treatment over some scenes; an error comes back as a value.

    `guard` and `observer` are those of `Taps`.
    """
    try:
        taps = taps_of(system, treatment, scenes, guard, observer)
        with set_apart(system):
            returned = system.run(treatment.variant, scenes, taps, treatment.seed)
            outcomes = _checked(system, scenes, returned)
        taps.verify()
        log = taps.delivery_log()
        counts = log.steps_faulted, log.steps_altered, taps.trajectory_hashes()
        noted = tuple(
            replace(
                outcome,
                faulted_steps=int(faulted),
                altered_steps=int(altered),
                trajectory_hash=trajectory,
            )
            for outcome, faulted, altered, trajectory in zip(outcomes, *counts, strict=True)
        )
        return Done(noted, log.counts())
    except UserError as error:
        return Failed(located(error))
    except SystemExit as error:
        message = f"the system called sys.exit({error.code!r}): raise an error or return outcomes"
        return Raised(message, traceback.format_exc())
    except Exception as error:
        message = described(error)
        if isinstance(error, ValueError) and "read-only" in message:
            message += " (what a tap delivers cannot be written to: copy it first)"
        return Raised(message, traceback.format_exc())


def _checked(system: System, scenes: Sequence[str], returned: object) -> list[Outcome]:
    several = isinstance(returned, Iterable)
    outcomes = list(cast("Iterable[Any]", returned)) if several else []
    others = [type(outcome).__name__ for outcome in outcomes if not isinstance(outcome, Outcome)]
    if others or not several:
        kind = f"{others[0]} in place of an Outcome" if others else type(returned).__name__
        raise SystemMistake(
            f"run() of system {system.name!r} returned a {kind}: it returns a list with one "
            "Outcome for each scene, in order"
        )
    if (names := [outcome.scene for outcome in outcomes]) != list(scenes):
        raise SystemMistake(
            f"system {system.name!r} was asked for scenes {list(scenes)} and returned outcomes of "
            f"{names}: run() returns one for each, in order"
        )
    return [checked(outcome, system.metrics) for outcome in outcomes]
