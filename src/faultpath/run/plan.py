"""Plans: treatments over identical scenes, their blocks, and which worker takes which."""

import hashlib
import json
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from pydantic import Field

from faultpath.core.results import Frozen
from faultpath.faults import Fault
from faultpath.system.declared import Library, SceneRef

_OBJECT = " object"


class SystemSpec(Frozen):
    """How a worker process builds the system: a registered name or `module:attribute`."""

    name: str
    options: dict[str, str] = Field(default_factory=dict[str, str])

    @classmethod
    def of_class(cls, kind: type) -> "SystemSpec":
        """Return what stands for an object of this class, which only its own process has."""
        return cls(name=f"{kind.__name__}{_OBJECT}")

    @property
    def is_object(self) -> bool:
        """Whether nothing can build the system again; no name of a factory reads like this."""
        return self.name.endswith(_OBJECT) and ":" not in self.name


class Treatment(Frozen):
    """One variant of the system under one set of faults, with one seed."""

    variant: str
    faults: tuple[Fault, ...] = ()
    """As `faultpath.faults.resolve` returns them."""
    seed: int = 0

    def key(self) -> str:
        """Content hash: treatments that would run the same trials have the same key."""
        # Sorted and in JSON, so that neither the order of fields nor the process decides the key.
        content = json.dumps(self.model_dump(mode="json"), sort_keys=True)
        return hashlib.sha256(content.encode()).hexdigest()[:16]

    def describe(self) -> str:
        """Return its faults in words."""
        return " and ".join(fault.describe() for fault in self.faults) or "correct inputs"


class Row(Frozen):
    """Place of a treatment in the outcome table; two rows may share one, which runs once."""

    variant: str
    condition: str
    seed: int
    treatment: Treatment
    scenes: tuple[str, ...] = ()
    """Those of the plan in which it runs; empty: all of them. Two rows of a treatment have the
    same scenes, or none in common."""


class Plan(Frozen):
    """Which treatments run over which scenes."""

    name: str
    system: SystemSpec
    library: str
    scenes: tuple[str, ...]
    rows: tuple[Row, ...]
    scenes_per_analysis: int = 0
    """Scenes of a sequential plan from one analysis of the results to the next, in the order of
    `scenes`. 0 runs them all, in the blocks of their library."""

    def treatments(self) -> tuple[Treatment, ...]:
        """Return each distinct treatment once, in the order of the rows."""
        return tuple({row.treatment.key(): row.treatment for row in self.rows}.values())


def selected(plan: Plan, library: Library) -> tuple[SceneRef, ...]:
    """Return the scenes of a plan by index."""
    known = {scene.id: scene for scene in library.scenes}
    return tuple(sorted((known[scene] for scene in plan.scenes), key=lambda scene: scene.index))


@dataclass(frozen=True)
class Unit:
    """One treatment over the scenes of one block, stored and resumed as a whole."""

    key: str
    """Content hash of everything that decides the result."""
    treatment: Treatment
    treatment_key: str
    """That of `treatment`, which a model computes anew each time."""
    block: int
    scenes: tuple[str, ...]
    part: tuple[str, ...] = ()
    """Scenes that its rows name; empty where they name none."""


def units_of(plan: Plan, library: Library, block_size: int, fingerprint: str) -> tuple[Unit, ...]:
    """Return every unit of a plan: block by block, in each the treatments in order.

    A block is a place in the library, not a count of selected scenes, so a selection and the whole
    library share the blocks that both hold in full. Those of a sequential plan are its analyses.
    """
    scenes: Sequence[SceneRef] = selected(plan, library)
    per_analysis = plan.scenes_per_analysis
    if per_analysis:  # in the order of the plan, not of the library
        places = {scene: place for place, scene in enumerate(plan.scenes)}
        scenes = sorted(scenes, key=lambda scene: places[scene.id])
    parts: dict[tuple[str, ...], dict[str, Treatment]] = {}
    for row in plan.rows:
        parts.setdefault(row.scenes, {})[row.treatment.key()] = row.treatment
    units: list[Unit] = []
    for part, treatments in parts.items():
        blocks: dict[int, list[str]] = {}
        within = frozenset(part)
        part_scenes = [scene for scene in scenes if scene.id in within] if part else scenes
        for place, scene in enumerate(part_scenes):
            block = place // per_analysis if per_analysis else scene.index // block_size
            blocks.setdefault(block, []).append(scene.id)
        contents = {key: treatment.model_dump(mode="json") for key, treatment in treatments.items()}
        for block, ids in blocks.items():
            for treatment_key, treatment in treatments.items():
                # The names here are part of the keys of stored trials: with another name all of
                # them would be run again.
                content = {
                    "system": fingerprint,
                    "treatment": contents[treatment_key],
                    "scenes": ids,
                    "library": library.content_hash,
                }
                key = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:32]
                units.append(Unit(key, treatment, treatment_key, block, tuple(ids), part))
    return tuple(units)


@dataclass(frozen=True)
class Task:
    """Some or all scenes of a unit, for one worker."""

    unit: Unit
    scenes: tuple[str, ...]
    recheck: Literal["sample", "guarded"] | None = None
    """Why it runs again: a few scenes without the others, or one alone with `Taps(guard=True)`.
    Its result is compared and not stored."""


class TaskQueue:
    """Tasks that wait for a worker.

    A system caches what it derives from a block's scenes, so a worker stays with its block, takes
    the one with the most work left when that is done, and helps out with another worker's only
    when no block is free. The longest work is thus never started last. `in_order`, all workers are
    at the first block that is left.
    """

    def __init__(self, units: Iterable[Unit], in_order: bool) -> None:
        self._in_order = in_order
        self._blocks: dict[int, deque[Task]] = {}
        for unit in units:
            self._blocks.setdefault(unit.block, deque()).append(Task(unit, unit.scenes))
        self._home: dict[int, int] = {}
        self._free = deque(sorted(self._blocks, key=self._left, reverse=True))
        """Blocks that were no worker's home, the one with the most work first."""

    def take(self, worker: int) -> Task | None:
        """Return the next task for a worker, or `None` when nothing waits."""
        if not self._blocks:
            return None
        home = min(self._blocks) if self._in_order else self._home.get(worker)
        if home not in self._blocks:
            home = self._free.popleft() if self._free else max(self._blocks, key=self._left)
            self._home[worker] = home
        tasks = self._blocks[home]
        task = tasks.popleft()
        if not tasks:
            del self._blocks[home]
        return task

    def _left(self, block: int) -> int:
        return sum(len(task.scenes) for task in self._blocks[block])

    def put(self, tasks: Sequence[Task]) -> None:
        """Put tasks back, before everything else of their block."""
        for task in reversed(tasks):
            self._blocks.setdefault(task.unit.block, deque()).appendleft(task)
