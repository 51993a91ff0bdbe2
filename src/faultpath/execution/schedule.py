"""Which worker does what next."""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from faultpath.execution.units import Unit


class Recheck(StrEnum):
    """Why scenes are flown that have been flown before."""

    SAMPLE = "sample"
    """A few scenes of a unit, without the others."""
    GUARDED = "guarded"
    """One scene by itself, with `Taps(guard=True)`."""
    ALONE = "alone"
    """The scene that was flown guarded, without the guard."""
    REPEAT = "repeat"
    """The whole unit."""


@dataclass(frozen=True)
class Task:
    """Some or all scenes of a unit, for one worker."""

    unit: Unit
    scenes: tuple[str, ...]
    retried: bool = False
    """A worker process died over it before."""
    recheck: Recheck | None = None
    """Its result is compared and not stored."""


class Schedule:
    """Tasks that wait for a worker.

    A system caches what it derives from a block's scenes, so a worker stays with its block, takes
    the one with the most work left when that is done, and helps out with another worker's only
    when no block is free. The longest work is thus never started last.
    """

    def __init__(self, units: Iterable[Unit]) -> None:
        self._blocks: dict[int, deque[Task]] = {}
        for unit in units:
            self._blocks.setdefault(unit.block, deque()).append(Task(unit, unit.scenes))
        self._home: dict[int, int] = {}

    def __len__(self) -> int:
        return sum(map(len, self._blocks.values()))

    def __bool__(self) -> bool:
        return bool(self._blocks)

    def take(self, worker: int) -> Task | None:
        """Return the next task for a worker, or `None` when nothing waits."""
        if not self._blocks:
            return None
        home = self._home.get(worker)
        if home not in self._blocks:
            home = self._home[worker] = self._choose()
        waiting = self._blocks[home]
        task = waiting.popleft()
        if not waiting:
            del self._blocks[home]
        return task

    def put(self, tasks: Iterable[Task]) -> None:
        """Put tasks back, before everything else of their block."""
        for task in reversed(tuple(tasks)):
            self._blocks.setdefault(task.unit.block, deque()).appendleft(task)

    def _choose(self) -> int:
        taken = set(self._home.values())
        free = [block for block in self._blocks if block not in taken]
        return max(free or self._blocks, key=self._work_left)

    def _work_left(self, block: int) -> int:
        return sum(len(task.scenes) for task in self._blocks[block])
