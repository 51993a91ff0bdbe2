"""The tasks of a plan on the workers of an executor, and what a worker does for them."""

import math
import os
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Generic, TypeVar

from faultpath.core.error_source import explained
from faultpath.core.errors import SystemMistake, UserError
from faultpath.run.apart import reads
from faultpath.run.code import Code, CodeState, Watch, named, source_state, system_code
from faultpath.run.plan import SystemSpec
from faultpath.run.registry import load_system, opened_by
from faultpath.run.work.executor import (
    Executor,
    Failed,
    Lost,
    Returned,
    elsewhere,
    send_message,
)
from faultpath.system.checks import library_of
from faultpath.system.declared import Library
from faultpath.system.system import System

_TICK_S = 0.5
_FALSE_STARTS = 4
"""So many workers in a row may die before they have built the system."""
LONGEST_S = 3600.0
"""For a block, unless the user or the system says otherwise."""
LEAST_S = 300.0
"""For building a system, whatever is said of a block: imports wait for a busy machine."""

T = TypeVar("T")


class UndeclaredFile(SystemMistake):
    """The system reads a file that is none of its sources and data files."""


@dataclass(frozen=True)
class BuildSpec:
    """System that a worker builds, the library of its scenes, and what both have to be."""

    system: SystemSpec
    library: str
    state: CodeState
    library_hash: str


@dataclass(frozen=True)
class Built:
    """The system of a job, as a process holds it for its tasks."""

    job: BuildSpec
    system: System
    library: Library
    code: Code
    unread: Watch

    @classmethod
    def of(cls, system: System, spec: SystemSpec, name: str) -> "Built":
        """Take the state that `system`, which `spec` builds, and one of its libraries have now."""
        library, code = library_of(system, name), system_code(system, spec)
        job = BuildSpec(spec, name, code.state, library.content_hash)
        return cls(job, system, library, code, Watch(code))

    def work(self, function: Callable[[System, Any], Any], task: Any) -> Any:
        """Return what a function of system and task returns.

        `UserError` where a file that it may have read has changed since the system was built, and
        as `check_files`.
        """
        self.check_files()
        try:
            with reads() as opened:
                done = function(self.system, task)
        finally:
            if changed := self.unread.changed():
                raise _under_way(changed)
        self.check_files(opened)
        return done

    def check_files(self, opened: Iterable[str] = ()) -> None:
        """Raise `UndeclaredFile` for a file that was read, now or when the system was built, and
        is neither source nor data. No trial of an object is ever taken for another's."""
        name, code = self.job.system.name, self.code
        if self.job.system.is_object or not (files := {*opened, *opened_by(name)}):
            return
        known = map(os.path.realpath, code.data.values())
        if unknown := sorted(files.difference(known)):
            names = [os.path.relpath(path, (code.main or Path()).parent) for path in unknown]
            raise UndeclaredFile(
                f"system {name!r} reads {named(names)}, which it does not declare: an edit there "
                "would go unnoticed, and old results would pass for new ones: give "
                f"`data_files={tuple(names)!r}` to its ComposedSystem, or name them in that "
                "property of its class"
            )


@dataclass
class _Running(Generic[T]):
    task: T
    tried: bool
    """Whether a worker was lost over it before."""
    since: float
    started: bool = False
    """Whether the system was built; its building has a limit of its own."""

    def start(self, message: object) -> None:
        del message
        self.started, self.since = True, time.monotonic()

    def overran(self, limit_s: float, system: str) -> bool:
        """Return whether its time is over; `UserError` where `system` was not built in time."""
        allowed = limit_s if self.started else max(LEAST_S, limit_s)
        if time.monotonic() - self.since <= allowed:
            return False
        if not self.started:
            raise UserError(
                f"system {system!r} was not built in a worker process within "
                f"{allowed:g} s: look for what its factory or its file waits for, or allow "
                "more with --time-limit"
            )
        return True


def dispatch(
    executor: Executor,
    built: Built,
    work: Callable[[System, T], Any],
    take: Callable[[int], T | None],
    handle_reply: Callable[[T, Any], None],
    limit_s: float | None = None,
    report: Callable[[], None] = lambda: None,
) -> None:
    """Run what `take` returns for a worker, until it returns nothing and all tasks have ended.

    `work`, a function of a module, gets the system and the task. `handle_reply` gets what it
    returned, `Failed` with an error that it raised, or `Lost` where a worker was lost over the task
    twice or stopped at the time limit: `limit_s`, else what the system says, else an hour.
    """
    if limit_s is not None and not (math.isfinite(limit_s) and limit_s > 0):
        raise UserError(f"the time limit is {limit_s:g} s: give a number of seconds above 0")
    limit_s = limit_s or built.system.time_limit_s or LONGEST_S
    call = partial(built.work, work)
    if executor.count:
        call = partial(_elsewhere, built.job, work)
    running: dict[int, _Running[T]] = {}
    lost: list[tuple[T, bool]] = []
    """Tasks whose worker was lost: one loss is nobody's fault, and a second one is the task's."""
    false_starts = 0
    while True:
        for worker in executor.free():
            task, tried = lost.pop(0) if lost else (take(worker), False)
            if task is not None:
                run = running[worker] = _Running(task, tried, time.monotonic())
                executor.submit(worker, partial(call, task), run.start)
        if not running:
            return
        for worker, end in executor.completions(_TICK_S):
            run = running.pop(worker)
            false_starts = 0 if run.started else false_starts
            if isinstance(end, Returned):
                handle_reply(run.task, end.value)
            elif isinstance(end, Failed) or (run.started and run.tried):
                handle_reply(run.task, end)
            elif run.started:
                lost.append((run.task, True))
            else:
                false_starts += 1
                if false_starts > _FALSE_STARTS:
                    raise UserError(f"worker processes failed to start: {end.how}")
                lost.append((run.task, run.tried))
        # After the completions, so that a task that has just ended was in time.
        for worker, run in tuple(running.items()):
            if run.overran(limit_s, built.job.system.name):
                executor.cancel(worker)
                del running[worker]
                handle_reply(run.task, Lost(f"it was stopped at the time limit of {limit_s:g} s"))
        report()


_built: list[Built] = []
"""System that this worker process built last."""


def _elsewhere(job: BuildSpec, work: Callable[[System, Any], Any], task: Any) -> Any:
    """Work on a task in a worker process, which keeps the system, and tell when that is built.

    Raises where the system cannot be built or is another one here.
    """
    if not _built or _built[0].job != job:
        _built.clear()  # before: two systems may not fit into memory, and a failed one leaves none
        try:
            _built.append(_build(job))
        except (Exception, SystemExit) as error:
            mistake = explained(error) or error
            if elsewhere() and isinstance(mistake, UserError | OSError | ImportError):
                raise UserError(
                    f"on {elsewhere()}: {mistake} (every node needs the same files and packages, "
                    "from a shared file system, an image, or `ray job submit --working-dir`)"
                ) from error
            if mistake is error:
                raise
            raise mistake from error
    send_message("built")
    return _built[0].work(work, task)


def _build(job: BuildSpec) -> Built:
    before = source_state(job.system)
    system = load_system(job.system)
    built = Built.of(system, job.system, job.library)
    _check_same(before, built.job.state)
    if built.job != job:
        differ = named(job.state.changed(built.job.state) or ("the library",))
        other = f"system {job.system.name!r} is another one"
        if place := elsewhere():
            raise UserError(f"{other} on {place} than here ({differ})")
        _check_same(job.state, built.job.state)
        raise UserError(
            f"{other} in a worker process than here ({differ}): nothing of it may depend on the "
            "process that builds it"
        )
    return built


def _check_same(before: CodeState, after: CodeState) -> None:
    """Raise `UserError` where a file has other contents now; files in one of them alone may be."""
    changed = [
        name
        for mine, theirs in ((before.files, after.files), (before.data, after.data))
        for name, digest in mine.items()
        if theirs.get(name, digest) != digest
    ]
    if changed:
        raise _under_way(changed)


def _under_way(names: Sequence[str]) -> UserError:
    return UserError(
        f"{named(names)} changed while the run was under way: trials of the code before are kept "
        "as such and not mixed with others; run the command again to run the code as it is now"
    )
