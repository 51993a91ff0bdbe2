"""`check` and `trace` from Python: what `faultpath check` and `faultpath trace` print, as data."""

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING

from faultpath.trials import System

if TYPE_CHECKING:
    from faultpath.door.display import Display
    from faultpath.door.systems import Chosen
    from faultpath.review.check import Report
    from faultpath.review.tracing import TraceReport


def check(
    system: str | PathLike[str] | System,
    *,
    variants: Sequence[str] = (),
    library: str = "selection",
    scenes: int = 4,
    seed: int = 0,
    options: Mapping[str, object] | None = None,
    workers: int | None = None,
    time_limit_s: float | None = None,
    progress: "bool | Display" = True,
) -> "Report":
    """Check that a system keeps what an audit takes for granted.

    Trials repeat and can be paired, modules read what is declared, a fault reaches every tap. What
    comes back has `checks`, each with its `status`, and all `failures` in a sentence each.

    Args:
        system: As for `faultpath.audit`.
        variants: Which to check; none named: all, or the first two of more than four.
        library: Library of scenes, by name or file.
        scenes: How many of its first scenes.
        seed: Of the trials.
        options: The system's own options.
        workers: Worker processes, by default two where that helps; 0, and an object of your own,
            cannot show what differs from process to process.
        time_limit_s: Seconds that a flight may take in a worker.
        progress: As for `faultpath.audit`.

    Raises:
        UserError: There is no such system, variant or library, or it cannot be built.
    """
    from faultpath.door.display import display
    from faultpath.door.systems import choose
    from faultpath.review.check import Asked, check_system
    from faultpath.work import Progress

    given = dict(locals())
    chosen = choose(system, options or {}, workers, variants)
    helpful = 2 if chosen.system.parallel else 1
    count = helpful if chosen.workers is None else chosen.workers
    told = display(progress, "check", given | {"system": chosen.spec.name})
    if chosen.notice:
        told.say(chosen.notice)
    with told.progress("Checking") as show:

        def note(done: int, known: int | None) -> None:
            show(
                Progress(done, known, f"{done} of {known} flights" if known else f"{done} flights")
            )

        asked = Asked(tuple(variants), library, scenes, seed, count, time_limit_s)
        return check_system(chosen.system, chosen.spec, asked, note)


def trace(
    system: str | PathLike[str] | System,
    *,
    variant: str | None = None,
    steps: int = 3,
    scene: str | None = None,
    library: str = "selection",
    seed: int = 0,
    fault: str | None = None,
    options: Mapping[str, object] | None = None,
) -> "TraceReport":
    """Run a variant for a few steps, and tell who read what, when, and from whom.

    What comes back has `reads` in their order, and as `findings` where they are not as declared.

    Args:
        system: As for `faultpath.audit`.
        variant: Default the first.
        steps: Control steps.
        scene: By its id; default the first of the library.
        library: Library of scenes, by name or file.
        seed: Of the trial.
        fault: As for `faultpath.audit`, to see whom it reaches.
        options: The system's own options.

    Raises:
        UserError: There is no such system, variant, library or scene, the fault strikes nobody, or
            the run fails.
    """
    from faultpath.door.systems import choose

    chosen = choose(system, options or {}, None, (variant,) if variant else ())
    return traced(chosen, variant, library, scene, steps, seed, fault)


def traced(
    chosen: "Chosen",
    variant: str | None,
    library: str,
    scene: str | None,
    steps: int,
    seed: int,
    fault: str | None,
) -> "TraceReport":
    """Return the trace of a system that is built; raises as `trace`."""
    from faultpath.review.tracing import trace_system

    built = chosen.system
    struck = None
    if fault is not None:
        struck = built.fault(fault)
    name = variant or next(iter(built.variants))
    return trace_system(built, chosen.spec, name, library, scene, steps, seed, struck)
