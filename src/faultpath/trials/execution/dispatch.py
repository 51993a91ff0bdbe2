"""The tasks of a study on the workers of an executor."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from faultpath.core.errors import UserError
from faultpath.trials.attempt import Died, Wrong
from faultpath.trials.execution.worker import Started
from faultpath.trials.system import System
from faultpath.trials.work import Call, Executor, Failed, Lost, WorkerLost

_TICK_S = 0.5
_FALSE_STARTS = 4
"""So many workers in a row may die before they have built the system."""


LONGEST_S = 3600.0
"""For a block, unless the user or the system says otherwise."""
LEAST_S = 300.0
"""For building a system, whatever is said of a block: imports wait for a busy machine."""


def block_limit_s(system: System, asked_s: float | None) -> float:
    """Return the seconds that a block may take: as asked, as the system says, or an hour."""
    if asked_s is not None and not (math.isfinite(asked_s) and asked_s > 0):
        raise UserError(f"the time limit is {asked_s:g} s: give a number of seconds above 0")
    return asked_s or system.time_limit_s or LONGEST_S


T = TypeVar("T")


@dataclass
class _Running(Generic[T]):
    task: T
    since: float
    lost: int = 0
    """How many workers were lost over it."""
    started: bool = False
    """Whether the system was built; its building has a limit of its own."""


class Dispatch(Generic[T]):
    """Hands tasks to the workers of an executor, watches their time, and takes replies in.

    `call` is what runs a task, and tells `Started`; `limit_s` is how long one may take; `name` is
    that of the system.
    """

    def __init__(
        self, executor: Executor, call: Callable[[T], Call], limit_s: float, name: str
    ) -> None:
        self._executor, self._call, self._limit_s, self._name = executor, call, limit_s, name
        self._running: dict[int, _Running[T]] = {}
        self._again: list[tuple[T, int]] = []
        """Tasks whose worker was lost, through no fault of theirs that is known."""
        self._false_starts = 0

    def run(
        self,
        take: Callable[[int], T | None],
        settle: Callable[[T, Any], None],
        report: Callable[[], None] = lambda: None,
    ) -> None:
        """Run what `take` returns for a worker, until it returns nothing and all is settled.

        `settle` gets what the call returned, `Wrong` for an error that it raised, or `Died`.
        """
        while True:
            for worker in self._executor.free():
                task, lost = self._again.pop(0) if self._again else (take(worker), 0)
                if task is not None:
                    self._submit(worker, task, lost)
            if not self._running:
                return
            for worker, end in self._executor.completions(_TICK_S):
                running = self._running.pop(worker)
                if isinstance(end, Failed):
                    settle(running.task, Wrong(end.error))
                elif not isinstance(end, Lost):
                    settle(running.task, end.value)
                elif not running.started:
                    self._false_starts += 1
                    if self._false_starts > _FALSE_STARTS:
                        raise WorkerLost(f"worker processes do not come up: {end.how}")
                    self._again.append((running.task, running.lost))
                elif running.lost < self._executor.retries:
                    self._again.append((running.task, running.lost + 1))
                else:
                    settle(running.task, Died(end.how))
            now = time.monotonic()
            for worker, running in tuple(self._running.items()):
                allowed = self._limit_s if running.started else max(LEAST_S, self._limit_s)
                if now - running.since <= allowed:
                    continue
                if not running.started:
                    raise UserError(
                        f"system {self._name!r} was not built in a worker process within "
                        f"{allowed:g} s: look for what its factory or its file waits for, or allow "
                        "more with --time-limit"
                    )
                self._executor.cancel(worker)
                del self._running[worker]
                how = f"it was stopped at the time limit of {allowed:g} s"
                settle(running.task, Died(how, late=True))
            report()

    def _submit(self, worker: int, task: T, lost: int) -> None:
        running = self._running[worker] = _Running(task, time.monotonic(), lost)

        def on_message(message: Started) -> None:
            running.started, running.since = True, time.monotonic()
            self._false_starts = 0

        self._executor.submit(worker, self._call(task), on_message)
