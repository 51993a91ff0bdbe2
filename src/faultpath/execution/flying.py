"""The tasks of a study on the workers of an executor."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from faultpath.execution.attempt import Died, Wrong
from faultpath.execution.limits import TimeLimit
from faultpath.execution.worker import Started, Undeclared
from faultpath.patience import too_late
from faultpath.work import Call, End, Executor, Failed, Lost, WorkerLost

_TICK_S = 0.5
_FALSE_STARTS = 4
"""So many workers in a row may die before they have built the system."""


class Scened(Protocol):
    """Some scenes to fly."""

    @property
    def scenes(self) -> tuple[str, ...]:
        """Scene ids."""
        ...


T = TypeVar("T", bound=Scened)


@dataclass
class _Running(Generic[T]):
    task: T
    since: float
    started: bool = False
    """Whether the system was built; its building has a limit of its own."""
    lost: int = 0
    """How many workers were lost over it."""


class Flying(Generic[T]):
    """Hands tasks out, watches their time, and makes a reply of what comes back.

    `call` is what flies a task, and tells `Started`; `name` is that of the system.
    """

    def __init__(
        self, executor: Executor, call: Callable[[T], Call], limit: TimeLimit, name: str
    ) -> None:
        self._executor, self._call, self._limit, self._name = executor, call, limit, name
        self._running: dict[int, _Running[T]] = {}
        self._again: list[_Running[T]] = []
        """Whose worker was lost, through no fault of theirs that is known."""
        self._false_starts = 0
        self.undeclared: set[str] = set()
        """Files that the system has read and does not name among its data files."""

    def run(
        self,
        take: Callable[[int], T | None],
        settle: Callable[[T, Any], None],
        report: Callable[[], None],
    ) -> None:
        """Run what `take` returns for a worker, until it returns nothing and all is settled.

        `settle` gets what the call returned, `Wrong` for an error that it raised, or `Died`.
        """
        while True:
            for worker in self._executor.free():
                if self._again:
                    again = self._again.pop(0)
                    self._submit(worker, again.task, again.lost)
                elif task := take(worker):
                    self._submit(worker, task)
            if not self._running:
                return
            for worker, end in self._executor.completions(_TICK_S):
                running = self._running.pop(worker)
                if isinstance(end, Lost) and self._worth_another(running, end):
                    self._again.append(running)
                else:
                    settle(running.task, _reply(end))
            for task, reply in self._stop_late():
                settle(task, reply)
            report()

    def _submit(self, worker: int, task: T, lost: int = 0) -> None:
        running = self._running[worker] = _Running(task, time.monotonic(), lost=lost)

        def told(message: Started | Undeclared) -> None:
            if isinstance(message, Undeclared):
                self.undeclared.update(message.paths)
            else:
                running.started, running.since = True, time.monotonic()
                self._false_starts = 0

        self._executor.submit(worker, self._call(task), told)

    def _worth_another(self, running: _Running[T], end: Lost) -> bool:
        if not running.started:
            self._false_starts += 1
            if self._false_starts > _FALSE_STARTS:
                raise WorkerLost(f"worker processes do not come up: {end.how}")
            return True
        running.lost += 1
        return running.lost <= self._executor.retries

    def _stop_late(self) -> list[tuple[T, Died]]:
        late: list[tuple[T, Died]] = []
        now = time.monotonic()
        for worker, running in tuple(self._running.items()):
            building, task = not running.started, running.task
            allowed = self._limit.building_s if building else self._limit.seconds(len(task.scenes))
            if now - running.since <= allowed:
                continue
            if building:
                raise too_late(self._name, allowed, " in a worker process")
            self._executor.cancel(worker)
            del self._running[worker]
            how = f"it was stopped at the time limit of {allowed:g} s"
            late.append((task, Died(how, late=True)))
        return late


def _reply(end: End) -> Any:
    if isinstance(end, Failed):
        return Wrong(end.error)
    return Died(end.how) if isinstance(end, Lost) else end.value
