"""Calls before an audit, `faultpath.check` and `api.trace`."""

from os import PathLike
from typing import TYPE_CHECKING, Any

from faultpath.analyses.analysis import faults_by_condition
from faultpath.api.display import Display
from faultpath.api.job import begin, with_question_signature
from faultpath.faults import Fault
from faultpath.run.question import CheckQuestion, TraceQuestion
from faultpath.run.work.executor import Progress
from faultpath.system.system import System

if TYPE_CHECKING:
    from faultpath.report.checks import Report, TraceReport


@with_question_signature(CheckQuestion)
def check(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> "Report":
    """Check that a system keeps what an audit takes for granted.

    Trials repeat and can be paired, modules read what is declared, a fault reaches every injection
    point. What comes back has `checks`, each with its `status`, and all `failures` in a sentence
    each.

    Args:
        system: As for `faultpath.audit`; an object of your own is checked in this process.
        progress: As for `faultpath.audit`.
        **arguments: ...

    Raises:
        UserError: There is no such system, variant or library, or it cannot be built.
    """
    from faultpath.report.checks import report_of
    from faultpath.run.check.check import chosen_variants, run_checks

    question, chosen, _, display = begin("check", CheckQuestion, system, arguments, progress)
    conditions: dict[str, dict[str, tuple[Fault, ...]]] = {}
    if question.fault is not None:
        variants = chosen_variants(chosen.system, question.variants)
        conditions = faults_by_condition(chosen.system.fault(question.fault), variants)
    if chosen.own:
        question = question.model_copy(update={"workers": 0})
    with display.progress("Checking") as show:

        def note(done: int, known: int | None) -> None:
            show(Progress(done, known, f"{done} of {known} runs" if known else f"{done} runs"))

        return report_of(run_checks(chosen.system, chosen.spec, question, note, conditions))


@with_question_signature(TraceQuestion)
def trace(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> "TraceReport":
    """Run a variant for a few steps, and show who read what, when, and from whom.

    What comes back has `reads` in their order, and as `findings` where they are not as declared.

    Args:
        system: As for `faultpath.audit`.
        progress: As for `faultpath.audit`.
        **arguments: ...

    Raises:
        UserError: There is no such system, variant, library or scene, the fault reaches no
            module, or the run fails.
    """
    from faultpath.report.checks import trace_report_of
    from faultpath.run.check.tracing import trace_system

    question, chosen, _, _ = begin("api.trace", TraceQuestion, system, arguments, progress)
    return trace_report_of(trace_system(chosen.system, chosen.spec, question))
