"""`faultpath.plan`: what to audit first, as a study file; and carrying such a file out."""

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faultpath.door.audit import audit, checked_count, checked_seeds, checked_texts
from faultpath.door.display import Display, display
from faultpath.door.systems import choose
from faultpath.errors import UserError
from faultpath.files.opening import contents
from faultpath.planning import plan_audit
from faultpath.proposal.plan import Plan, Proposal
from faultpath.proposal.sources import parsed
from faultpath.proposal.study import StudyFile, check_arms
from faultpath.proposal.words import sentences
from faultpath.setup_limit import setup_limit
from faultpath.store import write_text
from faultpath.store.atomic import check_writable
from faultpath.trials import System, library_of
from faultpath.work import Progress

if TYPE_CHECKING:
    from faultpath.door.run import Run


@dataclass(frozen=True, repr=False)
class Planned:
    """A plan that can be written as a study file, or carried out."""

    plan: Plan

    @property
    def sentences(self) -> tuple[str, ...]:
        """Why the first source is first, what is left open, trials and time."""
        return sentences(self.plan)

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
    ) -> "tuple[Run, ...]":
        """Carry the study out, as `faultpath audit --study` does; the same call resumes."""
        return audit_study(self.plan.study, folder=folder, workers=workers, progress=progress)

    def __repr__(self) -> str:
        """Return the audits and the first sentence."""
        names = ", ".join(each.name for each in self.plan.study.audits)
        return f"<Plan of {names}: {self.sentences[0]}>"

    def _repr_html_(self) -> str:
        from faultpath.report.proposal import by_audit, by_rank
        from faultpath.tables.html import html

        return "".join(html(table) for table in (by_rank(self.plan), by_audit(self.plan)))


def plan(
    system: str | PathLike[str] | System,
    *,
    baseline: str,
    repair: str,
    fault: str | Sequence[str] = (),
    module: str | Sequence[str] = (),
    library: str = "held-out",
    scenes: int | None = None,
    seeds: int | Sequence[int] = 0,
    options: Mapping[str, object] | None = None,
    progress: bool | Display = True,
) -> Planned:
    """Rank the uncertain sources of a system, and propose the audits of a repair.

    Where faultpath runs the system's modules itself, a few scenes are flown to probe sources;
    nothing is decided from them.

    Args:
        system: As for `audit`, but by name: a study file has to build it again.
        baseline: Variant to compare with.
        repair: Variant that is meant to help.
        fault: Expected errors, as faults of one size (`gain:scale=1.1`): for sources that declare
            none, and in place of what others declare.
        module: Modules that the repair changes, where what the variants read does not tell.
        library: Library of scenes.
        scenes: How many of its first scenes; `None` for all.
        seeds: Of the audits.
        options: The system's own options.
        progress: As for `audit`.

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
    """
    given = dict(locals())
    checked_texts(baseline=baseline, repair=repair, library=library)
    given |= {"fault": _several(fault), "module": _several(module)}
    drawn, count = checked_seeds(seeds), checked_count("scenes", scenes)
    called = isinstance(progress, Display) and progress.is_command
    with setup_limit(str(system), None) if called else nullcontext():
        chosen = choose(system, options or {}, None, (baseline, repair))
        scenes_from = library_of(chosen.system, library)
    if chosen.own:
        raise UserError(
            "a study file cannot hold an object: put what builds the system into a file and name "
            "that, as 'my_system.py:create'."
        )
    said = {"system": chosen.spec.name, "options": chosen.spec.options}
    told = display(progress, "plan", given | said)
    asked = Proposal(
        chosen.system,
        chosen.spec,
        baseline,
        repair,
        scenes_from,
        count,
        drawn,
        given["fault"],
        given["module"],
    )
    with told.progress("Planning") as show:

        def note(done: int, total: int) -> None:
            show(Progress(done, total, f"{done} of {total} flights"))

        return Planned(asked.make(note))


def _several(given: str | Sequence[str]) -> tuple[str, ...]:
    return (given,) if isinstance(given, str) else tuple(given)


def check_new(file: Path) -> None:
    """Raise `UserError` unless a file can be written there and none stands in its place."""
    check_writable(file)
    if file.exists():
        raise UserError(f"{file} is there already: give another file with --out, or remove it.")


def audit_study(
    study: StudyFile,
    *,
    folder: str | PathLike[str] | None = None,
    progress: bool | Display = True,
    **flying: Any,
) -> "tuple[Run, ...]":
    """Carry out the audits of a study, once all fit the system; they share what workers fly.

    `flying` is what `audit` takes of how to fly: workers and limits. Raises as `audit`, and for a
    file that does not fit the system any more.
    """
    asked: dict[str, Any] = {
        "baseline": study.baseline,
        "repair": study.repair,
        "scenes": study.scenes,
        "seeds": checked_seeds(study.seeds),
    }
    chosen = choose(study.system, study.options, None, (study.baseline, study.repair))
    library = library_of(chosen.system, study.library)
    for each in study.audits:
        laid = plan_audit(
            chosen.system,
            chosen.spec,
            fault=parsed(chosen.system, each.fault),
            fault_text=each.fault,
            library=library,
            **asked,
        )
        check_arms(study, each, laid)
    runs: list[Run] = []
    for each in study.audits:
        run = audit(
            study.system,
            fault=each.fault,
            library=study.library,
            options=study.options,
            folder=None if folder is None else Path(folder) / each.name,
            progress=progress,
            share=None if folder is None else Path(folder) / ".shared",
            **asked,
            **flying,
        )
        runs.append(run)
    return tuple(runs)
