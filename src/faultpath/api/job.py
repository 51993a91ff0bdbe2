"""From a call or a command line to a question, a job that runs its trials, and a finished run."""

import hashlib
import inspect
import re
import textwrap
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

from faultpath.analyses.analysis import Analysis, Items
from faultpath.api.display import Display, display
from faultpath.api.systems import Chosen, choose, executor_of
from faultpath.core.errors import UserError
from faultpath.core.text import counted, unknown
from faultpath.report.sentences.findings import describe
from faultpath.run.code import system_code
from faultpath.run.execution.runner import Failure, RunResult, run_plan
from faultpath.run.provenance import RunProvenance, run_provenance
from faultpath.run.question import Request, Running, ScanCall, UserQuestion, ask
from faultpath.run.store.folder import keyed
from faultpath.run.work.executor import Executor, Progress
from faultpath.system.checks import library_of
from faultpath.system.declared import Library
from faultpath.system.system import System

_Call = TypeVar("_Call", bound=Callable[..., Any])
_Question = TypeVar("_Question", bound=Request)

_ERRORS_SHOWN = 5
_LONGEST_NAME = 180
"""Longest name of a run folder; file systems take 255 bytes."""


def with_question_signature(model: type[UserQuestion]) -> Callable[[_Call], _Call]:
    """Give a function whose last parameter is `**arguments` signature and help of a model."""

    def described(function: _Call) -> _Call:
        signature = inspect.signature(function)
        parameters = [
            parameter
            for parameter in signature.parameters.values()
            if parameter.kind != parameter.VAR_KEYWORD
        ]
        lines: list[str] = []
        for name, info in model.model_fields.items():
            default = inspect.Parameter.empty
            if not info.is_required():
                default = info.get_default(call_default_factory=True)
            kind = inspect.Parameter.KEYWORD_ONLY
            parameters.append(
                inspect.Parameter(name, kind, default=default, annotation=info.annotation)
            )
            text, more = f"{name}: {info.description}", " " * 8
            lines.append(textwrap.fill(text, 96, initial_indent=" " * 4, subsequent_indent=more))
        vars(function)["__signature__"] = signature.replace(parameters=parameters)
        help = inspect.cleandoc(function.__doc__ or "")  # Python 3.13 takes the indent away itself
        function.__doc__ = help.replace("    **arguments: ...", "\n".join(lines))
        return function

    return described


def begin(
    call: str,
    model: type[_Question],
    system: str | PathLike[str] | System,
    arguments: Mapping[str, object],
    progress: bool | Display,
) -> tuple[_Question, Chosen, Library, Display]:
    """Read a question, build its system and find its scenes; `call` is the name of the function.

    `UserError` for what does not fit, named as its caller names it, for a library that does not
    exist, and as `choose`. Where no library is named, a system's only one is taken.
    """
    question = ask(model, arguments, isinstance(progress, Display) and progress.is_command)
    how = vars(question)
    executor = how.get("executor", "local")
    chosen = choose(system, question.options, how.get("workers"), question.named_variants, executor)
    library = library_of(chosen.system, question.library)
    fields = {"system": chosen.spec.name, **question.model_dump(exclude_unset=True)}
    shown = display(progress, call, fields | {"options": chosen.spec.options})
    if chosen.own:
        shown.say(
            "The system is an object, so it runs in this process; one that is named, as "
            "'my_system.py:create', runs in several."
        )
    if library.name != question.library:
        if "library" in question.model_fields_set:
            name = unknown("library", question.library, (library.name,))
            raise UserError(f"{chosen.system.name}: {name}")
        shown.say(f"Scenes of '{library.name}', the only library of this system.")
    return question, chosen, library, shown


@dataclass(frozen=True)
class Job:
    """Where and on what the trials of one call run, and who is shown how far it is."""

    folder: Path
    executor: Executor
    display: Display
    time_limit_s: float | None = None
    """Longest that a block may take; `None` for what the system says."""
    started: datetime = field(default_factory=lambda: datetime.now(UTC))

    def trials(self, analysis: Analysis[Items]) -> tuple[Items, RunResult]:
        """Run the rounds of an analysis; return what they amount to, and the result of all trials.

        The folder of an analysis of several rounds serves other such analyses too.
        """
        rounds = analysis.rounds()
        current, several = next(rounds), bool(analysis.noun)
        computed, noticed = 0, set[str]()
        if analysis.system.backend:
            self.display.say(f"Computing with {analysis.system.backend}.")
        if current.notice:
            self.display.say(current.notice)

        def notice(text: str) -> None:
            # Later rounds keep what this call has just run: only the first says what it found.
            key = "Kept " if text.startswith("Kept ") else text
            if key not in noticed:
                noticed.add(key)
                self.display.say(text)

        with self.display.progress("Running") as show:

            def note(state: Progress) -> None:
                if several:
                    whole = (state.total or 0.0) * max(1.0, current.most / current.items)
                    remark = f"{current.items} {analysis.noun}"
                    state = state.within(max(state.done, whole), remark=remark)
                show(state)

            run = partial(
                run_plan,
                folder=self.folder,
                progress=note,
                notice=notice,
                system=analysis.system,
                executor=self.executor,
                time_limit_s=self.time_limit_s,
            )
            while True:
                result = run(current.plan, shared=several, recheck=not several, stop=current.stop)
                noticed.add("Kept ")
                computed += result.blocks_computed
                try:
                    current = rounds.send(result.trials)
                except StopIteration as end:
                    items = end.value
                    break
            if several:  # once more, with all trials there, to run a few of them a second time
                result = run(current.plan, shared=True)
                trials = len(result.trials)
                show(Progress(trials, trials, f"{current.items} {analysis.noun}"))
        blocks = result.blocks_kept + result.blocks_computed
        return items, replace(result, blocks_computed=computed, blocks_kept=blocks - computed)

    def finish(self, result: RunResult, names: Iterable[str], backend: str = "") -> RunProvenance:
        """Display failures and write the provenance, with digests of the files that `names` are.

        A command shows findings with what was decided; a call from Python is shown them here.
        """
        say = self.display.say
        if result.failures:
            failed = counted(len(result.failures), "trial")
            say(f"{failed} failed, whose pairs do not count.", "bold red")
        alike: dict[str, list[Failure]] = {}
        for failure in result.failures:
            alike.setdefault(failure.error, []).append(failure)
        for error, (first, *more) in list(alike.items())[:_ERRORS_SHOWN]:
            rest = f" and {len(more)} more trials" if more else ""
            details = f" ({first.details})" if first.details else ""
            say(f"  {first.scene}{rest}: {' '.join(error.split())}{details}")
        if len(alike) > _ERRORS_SHOWN:
            say(f"  and {len(alike) - _ERRORS_SHOWN} other errors, in {self.folder / 'failures'}")
        if not self.display.is_command:
            for finding in result.findings:
                say(describe(finding))
        return run_provenance(
            self.folder,
            names,
            result,
            self.started,
            self.display.command,
            self.executor,
            backend,
        )


@contextmanager
def job_of(
    question: Running | ScanCall, chosen: Chosen, analysis: Analysis[Any], display: Display
) -> Generator[Job]:
    """Yield the job that runs the trials of an analysis; its workers end with the `with` block."""
    place = run_folder(question, chosen, analysis.named)
    workers = 0 if chosen.own else question.workers
    with executor_of(chosen.system, workers, question.executor) as executor:
        yield Job(place, executor, display, question.time_limit_s)


def run_folder(question: Running | ScanCall, chosen: Chosen, named: Sequence[str]) -> Path:
    """Return the folder of a run.

    Without a folder of the caller's it is named after everything that makes it another run,
    which begins with `named`, and after the code as it is; of an absolute path, which says more of
    the machine than of the run, a digest stands for the folders. `UserError` for one that holds a
    run of an object, which may have been another.
    """
    parts = [*named, *(f"{key}-{value}" for key, value in sorted(chosen.spec.options.items()))]
    if question.scenes is not None:
        parts.append(f"{question.scenes}-scenes")
    if question.seeds != (0,):
        parts.append(f"seeds-{','.join(map(str, question.seeds))}")
    joined = "-".join(parts)
    short = re.sub(r"(?:^|(?<=[:,=-]))/(?:[^/:,]*/)*", "", joined)
    if short != joined:
        short = f"{short}-{hashlib.sha256(joined.encode()).hexdigest()[:8]}"
    name = re.sub(r"[^A-Za-z0-9.+=,_-]+", "_", short).strip("._")
    if len(name) > _LONGEST_NAME:
        name = f"{name[:_LONGEST_NAME]}-{hashlib.sha256(name.encode()).hexdigest()[:12]}"
    if question.folder is None and not chosen.own:
        return keyed(name, system_code(chosen.system, chosen.spec).state)
    # No hash tells two objects of a class apart, so each call has a folder of its own.
    stamp = datetime.now().strftime("%Y%m%d-%H%M%S-%f")
    place = question.folder or Path("runs") / f"{name}-{stamp}"
    if chosen.own and (place / "manifest.json").exists():
        raise UserError(
            f"{place} holds a run, and nothing shows whether it was of this same object: give "
            "another folder, or put what builds the system into a file and name that."
        )
    return place
