"""`faultpath.plan`: what to audit first, as a study file; and carrying such a file out."""

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from faultpath.api.asking import asks, begin
from faultpath.api.audit import audit
from faultpath.api.display import Display
from faultpath.api.runs import Run
from faultpath.api.systems import choose
from faultpath.core.errors import UserError
from faultpath.core.files.opening import contents
from faultpath.decisions.plan.plan import Plan, make_plan, sentences
from faultpath.decisions.plan.study import StudyFile, check_arms
from faultpath.decisions.planning import plan_audit
from faultpath.trials import System, library_of
from faultpath.trials.question import PlanQuestion, Question
from faultpath.trials.store import write_text
from faultpath.trials.store.atomic import check_writable
from faultpath.trials.work import Progress


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
        if path.exists() and (not path.is_file() or contents(path) != text.encode()):
            raise UserError(f"{path} is there already, and is another: give another file.")
        check_writable(path)
        write_text(path, text)
        return path

    def audit(
        self,
        folder: str | PathLike[str] | None = None,
        workers: int | None = None,
        progress: bool | Display = True,
    ) -> tuple[Run, ...]:
        """Carry the study out, as `faultpath audit --study` does; the same call resumes."""
        return audit_study(self.plan.study, folder=folder, workers=workers, progress=progress)

    def __repr__(self) -> str:
        """Return the audits and the first sentence."""
        names = ", ".join(each.name for each in self.plan.study.audits)
        return f"<Plan of {names}: {self.sentences[0]}>"

    def _repr_html_(self) -> str:
        from faultpath.decisions.tables.html import html
        from faultpath.report.plan import by_audit, by_rank

        return "".join(html(table) for table in (by_rank(self.plan), by_audit(self.plan)))


@asks(PlanQuestion)
def plan(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **given: Any
) -> Planned:
    """Rank the uncertain sources of a system, and propose the audits of a repair.

    Where faultpath runs the system's modules itself, a few scenes probe the sources; nothing is
    decided from them.

    Args:
        system: As for `audit`, but by name: a study file has to build it again.
        progress: As for `audit`.
        **given: ...

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
    """
    asked, chosen, library, display = begin("plan", PlanQuestion, system, given, progress)
    if chosen.own:
        raise UserError(
            "a study file cannot hold an object: put what builds the system into a file and name "
            "that, as 'my_system.py:create'."
        )
    with display.progress("Planning") as show:

        def note(done: int, total: int) -> None:
            show(Progress(done, total, f"{done} of {total} runs"))

        return Planned(make_plan(chosen.system, chosen.spec, asked, library, note))


def audit_study(
    study: StudyFile,
    *,
    folder: str | PathLike[str] | None = None,
    progress: bool | Display = True,
    **running: Any,
) -> tuple[Run, ...]:
    """Carry out the audits of a study, once all fit the system.

    `running` is what `audit` takes of how to run: workers and limits. Raises as `audit`, and for a
    file that does not fit the system any more.
    """
    chosen = choose(study.system, study.options, None, (study.baseline, study.repair))
    library = library_of(chosen.system, study.library)
    for each in study.audits:
        laid = plan_audit(chosen.system, chosen.spec, study.audit_of(each.fault), library)
        check_arms(study, each, laid)
    same = {name: getattr(study, name) for name in Question.model_fields}
    return tuple(
        audit(
            study.system,
            fault=each.fault,
            folder=None if folder is None else Path(folder) / each.name,
            progress=progress,
            **same,
            **running,
        )
        for each in study.audits
    )
