"""What a worker does for a study: builds the system of a job, then runs its tasks."""

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass

from faultpath.core.error_source import explained
from faultpath.core.errors import UserError
from faultpath.trials.arm import Arm, SystemSpec
from faultpath.trials.attempt import Reply, Wrong, attempt
from faultpath.trials.code import CodeState, Watch, named
from faultpath.trials.registry import load_system
from faultpath.trials.state import source_state, system_code
from faultpath.trials.system import System
from faultpath.trials.work import WorkerLost, elsewhere, tell


@dataclass(frozen=True)
class Job:
    """What to build: a system, the library whose scenes it runs, and what both have to be."""

    system: SystemSpec
    library: str
    state: CodeState
    library_hash: str


@dataclass(frozen=True)
class Started:
    """The system is built, and the task begins."""


@dataclass(frozen=True)
class Built:
    """A system that a process keeps for its next tasks."""

    job: Job
    system: System
    unread: Watch


_ALIKE = (
    "every node needs the same files and packages, from a shared file system, an image, or "
    "`ray job submit --working-dir`"
)

_built: list[Built] = []
"""What this worker process has built last."""


def run_task(job: Job, arm: Arm, scenes: tuple[str, ...], guard: bool = False) -> Reply:
    """Run an arm over some scenes in a process of its own, which keeps what it has built.

    It tells `Started`. `guard` is that of `Taps`. Raises what makes the audit itself wrong, and
    where the system cannot be built or is another one here.
    """
    with building(job) as built:
        return run_here(built.system, built.unread, arm, scenes, guard)


def run_here(
    system: System, unread: Watch, arm: Arm, scenes: tuple[str, ...], guard: bool = False
) -> Reply:
    """Run with a system that is built; raises what makes the audit itself wrong."""
    reply = attempt(system, arm, scenes, guard)
    if changed := unread.changed():  # before it was read
        raise _under_way(changed)
    if isinstance(reply, Wrong):
        raise reply.error
    return reply


@contextmanager
def building(job: Job) -> Generator[Built]:
    """Give a worker process the system of a job."""
    if not _built or _built[0].job != job:
        _built.clear()
        try:
            _built.append(_build(job))
        except (Exception, SystemExit) as error:
            mistake = explained(error) or error
            if elsewhere() and isinstance(mistake, UserError | OSError | ImportError):
                raise WorkerLost(f"on {elsewhere()}: {mistake} ({_ALIKE})") from error
            if mistake is error:
                raise
            raise mistake from error
    tell(Started())
    yield _built[0]


def _build(job: Job) -> Built:
    before = source_state(job.system)
    system = load_system(job.system)
    library = system.library(job.library)
    code = system_code(system, job.system)
    _check_same(before, code.state)
    if (code.state, library.content_hash) != (job.state, job.library_hash):
        differ = named(job.state.changed(code.state) or ("the library",))
        other = f"system {job.system.name!r} is another one"
        if place := elsewhere():
            raise WorkerLost(f"{other} on {place} than here ({differ})")
        _check_same(job.state, code.state)
        raise WorkerLost(
            f"{other} in a worker process than here ({differ}): nothing of it may depend on the "
            "process that builds it"
        )
    return Built(job, system, code.unread())


def _check_same(before: CodeState, now: CodeState) -> None:
    """Raise `UserError` where a file has other contents now; files in one of them alone may be."""
    changed = tuple(
        name
        for mine, theirs in ((before.files, now.files), (before.data, now.data))
        for name, digest in mine.items()
        if theirs.get(name, digest) != digest
    )
    if changed:
        raise _under_way(changed)


def _under_way(names: tuple[str, ...]) -> UserError:
    return UserError(
        f"{named(names)} changed while the run was under way: trials of the code before are kept "
        "as such and not mixed with others; run the command again to run the code as it is now"
    )
