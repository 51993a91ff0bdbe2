"""What a worker does for a study: builds the system that it is told, then flies what it is sent."""

from dataclasses import dataclass
from functools import cache

from faultpath.blame import explained
from faultpath.code import Code, CodeState, Reads, Watch, named
from faultpath.execution.attempt import Reply, Wrong, attempt
from faultpath.execution.changes import check_same, watched
from faultpath.trials.arm import Arm, SystemSpec
from faultpath.trials.registry import load_system
from faultpath.trials.state import source_state, system_code
from faultpath.trials.system import System
from faultpath.work import WorkerLost, tell


@dataclass(frozen=True)
class Brief:
    """What to build: a system, the library whose scenes it flies, and what both have to be."""

    system: SystemSpec
    library: str
    state: CodeState
    library_hash: str


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
class _Built:
    brief: Brief
    system: System
    code: Code
    unread: Watch


_built: list[_Built] = []
"""What this worker process has built last."""


def fly(brief: Brief, order: Order) -> Reply:
    """Fly in a process of its own, which keeps what it has built for the next order.

    It tells `Started`, and `Undeclared` files. Raises what makes the audit itself wrong, and where
    the system cannot be built or is another one here.
    """
    if not _built or _built[0].brief != brief:
        _built.clear()
        try:
            _built.append(_build(brief))
        except (Exception, SystemExit) as error:
            if mistake := explained(error):
                raise mistake from error
            raise
    built = _built[0]
    tell(Started())
    reply = fly_here(built.system, built.unread, order)
    if undeclared := _reads().undeclared(built.code):
        tell(Undeclared(undeclared))
    return reply


def fly_here(system: System, unread: Watch, order: Order) -> Reply:
    """Fly with a system that is built; raises what makes the audit itself wrong."""
    reply = watched(unread, attempt(system, order.arm, order.scenes, order.guard))
    if isinstance(reply, Wrong):
        raise reply.error
    return reply


def _build(brief: Brief) -> _Built:
    reads = _reads()
    before = source_state(brief.system)
    reads.forget()
    system = load_system(brief.system)
    opened = reads.opened()
    library = system.library(brief.library)
    code = system_code(system, brief.system)
    reads.forget(opened)  # scenes have a hash of their own
    check_same(before, code.state)
    if (code.state, library.content_hash) != (brief.state, brief.library_hash):
        check_same(brief.state, code.state)
        differ = brief.state.changed(code.state) or ("the library",)
        raise WorkerLost(
            f"system {brief.system.name!r} is another one in a worker process than here "
            f"({named(differ)}): nothing of it may depend on the process that builds it"
        )
    return _Built(brief, system, code, code.unread())


@cache
def _reads() -> Reads:
    reads = Reads()
    reads.start()
    return reads
