"""Units of work, one arm over one block of scenes, and which worker does what next."""

import hashlib
import json
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import groupby

from faultpath.trials.arm import Arm
from faultpath.trials.declared import Library, SceneRef
from faultpath.version import __version__


@dataclass(frozen=True)
class Unit:
    """One arm over the scenes of one block, stored and resumed as a whole."""

    key: str
    """Content hash of everything that decides the result."""
    arm: Arm
    block: int
    scenes: tuple[str, ...]


def blocks(scenes: Sequence[SceneRef], block_size: int) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Group scenes, given by index, into the blocks of their library.

    A block is a place in the library, not a count of selected scenes, so a selection and the
    whole library share the blocks that both hold in full.
    """
    for block, members in groupby(scenes, key=lambda scene: scene.index // block_size):
        yield block, tuple(scene.id for scene in members)


def plan(
    arms: Sequence[Arm],
    scenes: Sequence[SceneRef],
    block_size: int,
    library: Library,
    fingerprint: str,
    look: int = 0,
) -> tuple[Unit, ...]:
    """Return every unit: block by block, in each the arms in order.

    With a `look`, blocks are so many scenes in the order given.
    """
    parts = looks(scenes, look) if look else blocks(scenes, block_size)
    return tuple(
        Unit(_key(arm, ids, library, fingerprint), arm, block, ids)
        for block, ids in parts
        for arm in arms
    )


def looks(scenes: Sequence[SceneRef], look: int) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Group scenes by their place in the order in which they are flown."""
    for block, start in enumerate(range(0, len(scenes), look)):
        yield block, tuple(scene.id for scene in scenes[start : start + look])


def _key(arm: Arm, scenes: Sequence[str], library: Library, fingerprint: str) -> str:
    content = {
        "faultpath": __version__,
        "system": fingerprint,
        "arm": arm.model_dump(mode="json"),
        "scenes": list(scenes),
        "library": library.content_hash,
    }
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:32]


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
    when no block is free. The longest work is thus never started last. `in_order`, all workers are
    at the first block that is left.
    """

    def __init__(self, units: Iterable[Unit], in_order: bool = False) -> None:
        self._in_order = in_order
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
        home = min(self._blocks) if self._in_order else self._home.get(worker)
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
