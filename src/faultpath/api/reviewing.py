"""`faultpath.check` and `faultpath.trace`: what the commands print, as data."""

from os import PathLike
from typing import TYPE_CHECKING, Any

from faultpath.api.asking import asks, begin
from faultpath.api.display import Display
from faultpath.api.systems import Chosen
from faultpath.trials import System
from faultpath.trials.question import CheckQuestion, TraceQuestion
from faultpath.trials.work import Progress

if TYPE_CHECKING:
    from faultpath.systems.checks.check import Report
    from faultpath.systems.checks.tracing import TraceReport


@asks(CheckQuestion)
def check(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **given: Any
) -> "Report":
    """Check that a system keeps what an audit takes for granted.

    Trials repeat and can be paired, modules read what is declared, a fault reaches every tap. What
    comes back has `checks`, each with its `status`, and all `failures` in a sentence each.

    Args:
        system: As for `faultpath.audit`; an object of your own is checked in this process.
        progress: As for `faultpath.audit`.
        **given: ...

    Raises:
        UserError: There is no such system, variant or library, or it cannot be built.
    """
    from faultpath.systems.checks.check import check_system

    asked, chosen, _, display = begin("check", CheckQuestion, system, given, progress)
    if chosen.own:
        asked = asked.model_copy(update={"workers": 0})
    with display.progress("Checking") as show:

        def note(done: int, known: int | None) -> None:
            show(Progress(done, known, f"{done} of {known} runs" if known else f"{done} runs"))

        return check_system(chosen.system, chosen.spec, asked, note)


@asks(TraceQuestion)
def trace(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **given: Any
) -> "TraceReport":
    """Run a variant for a few steps, and tell who read what, when, and from whom.

    What comes back has `reads` in their order, and as `findings` where they are not as declared.

    Args:
        system: As for `faultpath.audit`.
        progress: As for `faultpath.audit`.
        **given: ...

    Raises:
        UserError: There is no such system, variant, library or scene, the fault reaches nobody, or
            the run fails.
    """
    asked, chosen, _, _ = begin("trace", TraceQuestion, system, given, progress)
    return traced(asked, chosen)


def traced(asked: TraceQuestion, chosen: Chosen) -> "TraceReport":
    """Return the trace of a system that is built; raises as `trace`."""
    from faultpath.systems.checks.tracing import trace_system

    system = chosen.system
    fault = None if asked.fault is None else system.fault(asked.fault)
    name = asked.variant or next(iter(system.variants))
    return trace_system(
        system, chosen.spec, name, asked.library, asked.scene, asked.steps, asked.seed, fault
    )
