"""Calls before an audit, `faultpath.check`, `api.trace` and `api.plan`; carrying plans out."""

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faultpath.api.audit import audit
from faultpath.api.display import Display, display
from faultpath.api.job import asks, begin
from faultpath.api.runs import Run
from faultpath.api.systems import Chosen, choose
from faultpath.core.errors import UserError
from faultpath.core.files.opening import contents
from faultpath.decisions.fault_groups import fault_of
from faultpath.decisions.model import CORRECT, SHARED
from faultpath.decisions.plan.order import repaired_modules
from faultpath.decisions.plan.plan import Plan, make_plan, sentences
from faultpath.decisions.plan.study import StudyFile, arms_of, check_arms
from faultpath.decisions.planning import faults_by_path, plan_audit, two_variants
from faultpath.faults import Fault
from faultpath.trials import System, library_of
from faultpath.trials.question import CheckQuestion, PlanQuestion, RepairQuestion, TraceQuestion
from faultpath.trials.store.atomic import check_output, write_text
from faultpath.trials.trust import ReceivedCode
from faultpath.trials.work.executor import Progress

if TYPE_CHECKING:
    from faultpath.systems.checks.check import Report
    from faultpath.systems.checks.tracing import TraceReport


@dataclass(frozen=True, repr=False)
class Planned:
    """A plan that can be written as a study file, or carried out."""

    plan: Plan

    @property
    def sentences(self) -> tuple[str, ...]:
        """Why the first source is first, what is left open, trials and time."""
        return tuple(sentences(self.plan))

    def write(self, file: str | PathLike[str]) -> Path:
        """Write the study file and return its path; `UserError` where another one stands."""
        path, text = Path(file), self.plan.study.yaml()
        if not path.is_file() or contents(path) != text.encode():
            check_output(path)
        write_text(path, text)
        return path

    def audit(
        self,
        folder: str | PathLike[str] | None = None,
        workers: int | None = None,
        progress: bool | Display = True,
    ) -> tuple[Run, ...]:
        """Carry the study out, as `faultpath audit --study` does; the same call resumes."""
        return audit_study(
            self.plan.study, folder=folder, workers=workers, progress=progress, trust=True
        )

    def __repr__(self) -> str:
        """Return the audits and the first sentence."""
        names = ", ".join(audit.name for audit in self.plan.study.audits)
        return f"<Plan of {names}: {self.sentences[0]}>"


@asks(PlanQuestion)
def plan(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> Planned:
    """Rank the uncertain sources of a system, and propose the audits of a repair.

    Where faultpath runs the system's modules itself, a few scenes probe the sources; they are not
    tested.

    Args:
        system: As for `audit`, but by name: a study file has to build it again.
        progress: As for `audit`.
        **arguments: ...

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
    """
    question, chosen, library, display = begin(
        "api.plan", PlanQuestion, system, arguments, progress
    )
    if chosen.own:
        raise UserError(
            "a study file cannot hold an object: put what builds the system into a file and name "
            "that, as 'my_system.py:create'."
        )
    with display.progress("Planning") as show:

        def note(done: int, total: int) -> None:
            show(Progress(done, total, f"{done} of {total} runs"))

        return Planned(make_plan(chosen.system, chosen.spec, question, library, note))


def audit_study(
    study: StudyFile,
    *,
    folder: str | PathLike[str] | None = None,
    progress: bool | Display = True,
    trust: bool = False,
    **running: Any,
) -> tuple[Run, ...]:
    """Carry out the audits of a study, once all fit the system.

    Without `trust` the system has to be an installed one, since the file may be anybody's.
    `running` is what `audit` takes of how to run: workers and limits. Raises as `audit`, and for a
    file that does not fit the system any more.
    """
    say = display(progress, "audit_study", {}).say
    received, arms = ReceivedCode("the study file", trust, say), (study.baseline, study.repair)
    chosen = choose(study.system, study.options, None, arms, received=received)
    system, library = chosen.system, library_of(chosen.system, study.library)
    named = {arm.path for planned in study.audits for arm in planned.arms if arm.role == "repaired"}
    modules = sorted(named - {CORRECT, SHARED})
    repaired = repaired_modules(system, *two_variants(system, study), modules)
    for planned in study.audits:
        laid = plan_audit(system, chosen.spec, study.audit_of(planned.fault), library)
        check_arms(study, planned, laid)
        roles = {arm.path: arm.role for arm in arms_of(laid, repaired)}
        for arm in planned.arms:
            if arm.role != (role := roles[arm.path]):
                raise UserError(
                    f"audit '{planned.name}' of the study file calls '{arm.path}' {arm.role}, and "
                    f"it is {role}: correct it, or let `faultpath plan` write the file anew."
                )
    same = {name: getattr(study, name) for name in RepairQuestion.model_fields}
    return tuple(
        audit(
            study.system,
            fault=planned.fault,
            folder=None if folder is None else Path(folder) / planned.name,
            progress=progress,
            **same,
            **running,
        )
        for planned in study.audits
    )


@asks(CheckQuestion)
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
    from faultpath.systems.checks.check import check_system, chosen_variants

    question, chosen, _, display = begin("check", CheckQuestion, system, arguments, progress)
    conditions: dict[str, dict[str, tuple[Fault, ...]]] = {}
    if question.fault is not None:
        fault = fault_of(chosen.system, question.fault)
        variants = chosen_variants(chosen.system, question.variants)
        conditions = faults_by_path(chosen.system, fault, variants)
    if chosen.own:
        question = question.model_copy(update={"workers": 0})
    with display.progress("Checking") as show:

        def note(done: int, known: int | None) -> None:
            show(Progress(done, known, f"{done} of {known} runs" if known else f"{done} runs"))

        return check_system(chosen.system, chosen.spec, question, note, conditions)


@asks(TraceQuestion)
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
    question, chosen, _, _ = begin("api.trace", TraceQuestion, system, arguments, progress)
    return traced(question, chosen)


def traced(question: TraceQuestion, chosen: Chosen) -> "TraceReport":
    """Return the trace of a system that is built; raises as `trace`."""
    from faultpath.systems.checks.tracing import trace_system

    fault = None if question.fault is None else fault_of(chosen.system, question.fault)
    return trace_system(chosen.system, chosen.spec, question, fault)
