"""What a worker does for a study: builds the system that it is told, then flies what it is sent."""

import gc
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache

from faultpath.blame import explained
from faultpath.code import Code, CodeState, Reads, Watch, named
from faultpath.errors import UserError
from faultpath.execution.attempt import Raised, Reply, Wrong, attempt
from faultpath.execution.limits import hold_to
from faultpath.prints import prints_of
from faultpath.trials.arm import Arm, SystemSpec
from faultpath.trials.registry import load_system
from faultpath.trials.state import source_state, system_code
from faultpath.trials.system import System
from faultpath.work import WorkerLost, elsewhere, tell


@dataclass(frozen=True)
class Brief:
    """What to build: a system, the library whose scenes it flies, and what both have to be."""

    system: SystemSpec
    library: str
    state: CodeState
    library_hash: str
    memory_gib: float | None = None
    """What the process may take once it has built the system; see `limits.hold_to`."""


@dataclass(frozen=True)
class Order:
    """An arm over some scenes. `guard` is that of `Taps`."""

    arm: Arm
    scenes: tuple[str, ...]
    guard: bool = False


@dataclass(frozen=True)
class Started:
    """The system is built, and the task begins."""


@dataclass(frozen=True)
class Undeclared:
    """Files that the system has read and does not name among its data files."""

    paths: tuple[str, ...]


@dataclass(frozen=True)
class Built:
    """A system that a process keeps for its next orders."""

    brief: Brief
    system: System
    code: Code
    unread: Watch


_ALIKE = (
    "every node needs the same files and packages, from a shared file system, an image, or "
    "`ray job submit --working-dir`"
)

_built: list[Built] = []
"""What this worker process has built last."""


def fly(brief: Brief, order: Order) -> Reply:
    """Fly in a process of its own, which keeps what it has built for the next order.

    It tells `Started`, and `Undeclared` files. Raises what makes the audit itself wrong, and where
    the system cannot be built or is another one here.
    """
    with building(brief) as built:
        reply = fly_here(built.system, built.unread, order)
    if brief.memory_gib is None or not isinstance(reply, Raised) or not _in_want(reply.error):
        return reply
    gc.collect()  # what the flight held is not to be held against the next one
    limit = f"the worker was held to its memory limit of {brief.memory_gib:g} GiB"
    return replace(reply, error=f"{reply.error} ({limit})")


def _in_want(error: str) -> bool:
    return "MemoryError" in error or "allocate memory" in error


@contextmanager
def building(brief: Brief) -> Generator[Built]:
    """Give a worker process the system of a brief, and tell files that it reads unnamed."""
    if not _built or _built[0].brief != brief:
        _built.clear()
        hold_to(None)
        try:
            with prints_of(brief.system.name.rpartition(":")[0] or brief.system.name):
                _built.append(_build(brief))
            hold_to(brief.memory_gib)
        except (Exception, SystemExit) as error:
            mistake = explained(error) or error
            if elsewhere() and isinstance(mistake, UserError | OSError | ImportError):
                raise WorkerLost(f"on {elsewhere()}: {mistake} ({_ALIKE})") from error
            if mistake is error:
                raise
            raise mistake from error
    built = _built[0]
    tell(Started())
    yield built
    if undeclared := _reads().undeclared(built.code):
        tell(Undeclared(undeclared))


def fly_here(system: System, unread: Watch, order: Order) -> Reply:
    """Fly with a system that is built; raises what makes the audit itself wrong."""
    reply = attempt(system, order.arm, order.scenes, order.guard)
    if changed := unread.changed():  # before it was read
        raise _under_way(changed)
    if isinstance(reply, Wrong):
        raise reply.error
    return reply


def _build(brief: Brief) -> Built:
    reads = _reads()
    before = source_state(brief.system)
    reads.forget()
    system = load_system(brief.system)
    opened = reads.opened()
    library = system.library(brief.library)
    code = system_code(system, brief.system)
    reads.forget(opened)  # scenes have a hash of their own
    _check_same(before, code.state)
    if (code.state, library.content_hash) != (brief.state, brief.library_hash):
        differ = named(brief.state.changed(code.state) or ("the library",))
        other = f"system {brief.system.name!r} is another one"
        if place := elsewhere():
            raise WorkerLost(f"{other} on {place} than here ({differ})")
        _check_same(brief.state, code.state)
        raise WorkerLost(
            f"{other} in a worker process than here ({differ}): nothing of it may depend on the "
            "process that builds it"
        )
    return Built(brief, system, code, code.unread())


@cache
def _reads() -> Reads:
    reads = Reads()
    reads.start()
    return reads


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


def _under_way(names: Sequence[str]) -> UserError:
    """Say that files changed under a run, and what becomes of it."""
    return UserError(
        f"{named(names)} changed while the run was under way: trials of the code before are kept "
        "as such and not mixed with others; run the command again to run the code as it is now"
    )
