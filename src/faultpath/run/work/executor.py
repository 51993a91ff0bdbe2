"""Executors, and how a list of calls runs on one."""

import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Self, TypeVar

from faultpath.core.errors import UserError

ONE_THREAD = dict.fromkeys(
    (
        "OMP_NUM_THREADS",
        "MKL_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "NUMEXPR_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS",
    ),
    "1",
)
"""Environment of a process in which numpy and torch, once imported, keep to one thread: workers
share the processors, and a sum over several threads may differ in its last bits."""


@contextmanager
def one_thread() -> Generator[None]:
    """Keep torch, where it is loaded, to one thread, and put back what was before."""
    torch = sys.modules.get("torch")
    before = torch.get_num_threads() if torch else 1
    if torch and before != 1:
        torch.set_num_threads(1)
    try:
        yield
    finally:
        if torch and before != 1:
            torch.set_num_threads(before)


T = TypeVar("T")

Call = Callable[[], Any]
"""Work of a worker: a function of a module, bound to its arguments with `functools.partial`, or
a method of a plain object. Unless it runs in this process, it and what it returns are pickled."""
OnMessage = Callable[[Any], None]
"""Called, in the process that submitted, with each message that the call sends."""

_TICK_S = 0.5


@dataclass(frozen=True)
class Returned:
    """The call returned."""

    value: Any


@dataclass(frozen=True)
class Failed:
    """The call raised an error; from another process, its traceback stands in the error's notes."""

    error: Exception


@dataclass(frozen=True)
class Lost:
    """The worker ended in the middle of the call."""

    how: str


End = Returned | Failed | Lost


def ignore(message: object) -> None:
    """Drop a message of a call."""
    del message


@dataclass(frozen=True)
class Progress:
    """How far work has come."""

    done: float
    total: float | None
    count: str
    """The same, in words."""
    seconds: float | None = None
    """Left; `None` until something can be known."""
    remark: str = ""

    def within(self, total: float, before: float = 0.0, remark: str = "") -> Self:
        """Return it as a part of something larger, of which `before` was done before it."""
        done, left = before + self.done, None
        if self.seconds is not None and self.total is not None and self.total > self.done:
            left = self.seconds / (self.total - self.done) * max(0.0, total - done)
        return replace(self, done=done, total=total, seconds=left, remark=remark)


class Executor(ABC):
    """Numbered workers, each with one thread and one call at a time.

    A worker keeps what its calls have left in memory, so that a caller who has related calls gives
    them to the same one. One that is lost or cancelled is replaced. Leaving the context ends all.
    """

    count: int = 0
    """Number of workers, started or not; 0 where calls run in this process: nothing is pickled, and
    no call can be cancelled."""
    name: str = ""
    """Name of where calls run, where that is not this machine."""

    @abstractmethod
    def free(self) -> Sequence[int]:
        """Return the workers that could begin a call now."""

    @abstractmethod
    def submit(self, worker: int, call: Call, on_message: OnMessage = ignore) -> None:
        """Hand a call to a free worker."""

    @abstractmethod
    def completions(self, timeout_s: float) -> Iterator[tuple[int, End]]:
        """Wait at most so long; pass on messages of calls and yield those that ended."""

    @abstractmethod
    def cancel(self, worker: int) -> None:
        """Stop a worker, in the middle of its work if need be; its call yields no end."""

    def close(self) -> None:
        """Stop every worker; what they have written to disk is whole."""
        for worker in range(max(1, self.count)):
            self.cancel(worker)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def run_each(
    executor: Executor,
    calls: Sequence[Call],
    on_message: Callable[[int, Any], None] = lambda place, message: None,
) -> Iterator[tuple[int, End]]:
    """Run calls and yield the place of each in `calls` with its end, as they end.

    `on_message` is called with the place of a call and each message that it sends.
    """
    queue = iter(enumerate(calls))
    running: dict[int, int] = {}
    while True:
        for worker, (place, call) in zip(executor.free(), queue, strict=False):
            running[worker] = place
            executor.submit(worker, call, partial(on_message, place))
        if not running:
            return
        for worker, end in executor.completions(_TICK_S):
            yield running.pop(worker), end


def run_all(executor: Executor, calls: Sequence[Callable[[], T]]) -> Iterator[tuple[int, T]]:
    """Run calls and yield the place of each in `calls` with what it returned, as they end.

    Raises the error of the first call that fails, and `UserError` where a worker ends.
    """
    for place, end in run_each(executor, calls):
        if isinstance(end, Failed):
            raise end.error
        if isinstance(end, Lost):
            raise UserError(f"{end.how}; run the same again: what was finished is kept")
        yield place, end.value


_places: list[str] = []


def live_on(place: str) -> None:
    """Note where this worker process is, in words, where that is not its caller's machine."""
    _places[:] = [place]


def elsewhere() -> str:
    """Return where this worker process is; empty on the machine of its caller."""
    return _places[0] if _places else ""


_on_message: ContextVar[OnMessage] = ContextVar("on_message", default=ignore)


def send_message(message: object) -> None:
    """Send a message to whoever submitted the call that runs here; outside of one, to nobody."""
    _on_message.get()(message)


def ended(call: Call, on_message: OnMessage) -> Returned | Failed:
    """Run a call on one thread and return its end. `sys.exit` is an error like any other."""
    before = _on_message.set(on_message)
    try:
        with one_thread():
            return Returned(call())
    except SystemExit as error:
        exited = RuntimeError(f"it called sys.exit({error.code!r})")
        exited.__cause__ = error
        return Failed(exited)
    except Exception as error:
        return Failed(error)
    finally:
        _on_message.reset(before)


class Here(Executor):
    """Runs each call in this process, for tests and debuggers."""

    def __init__(self) -> None:
        self._waiting: tuple[Call, OnMessage] | None = None

    def free(self) -> Sequence[int]:
        """Return 0 unless a call waits."""
        return () if self._waiting else (0,)

    def submit(self, worker: int, call: Call, on_message: OnMessage = ignore) -> None:
        """Keep the call until `completions` runs it."""
        assert worker in self.free()
        self._waiting = call, on_message

    def completions(self, timeout_s: float) -> Iterator[tuple[int, End]]:
        """Run the call that waits, however long it takes."""
        del timeout_s
        if self._waiting is not None:
            waiting, self._waiting = self._waiting, None
            yield 0, ended(*waiting)

    def cancel(self, worker: int) -> None:
        """Forget the call that waits; one that runs cannot be stopped."""
        del worker
        self._waiting = None
