"""Units of work, one treatment over one block of scenes, and which worker does what next."""

import hashlib
import json
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from faultpath.run.plan import Plan, Treatment, selected
from faultpath.system.declared import Library, SceneRef


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
    units: list[Unit] = []
    for part, treatments in plan.parts().items():
        blocks: dict[int, list[str]] = {}
        chosen = [scene for scene in scenes if scene.id in part] if part else scenes
        for place, scene in enumerate(chosen):
            block = place // per_analysis if per_analysis else scene.index // block_size
            blocks.setdefault(block, []).append(scene.id)
        dumped = [(t, t.key(), t.model_dump(mode="json")) for t in treatments]
        for block, ids in blocks.items():
            for treatment, treatment_key, treatment_content in dumped:
                # The names here are part of the keys of stored trials: with another name all of
                # them would be run again.
                content = {
                    "system": fingerprint,
                    "treatment": treatment_content,
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

    def __init__(self, units: Iterable[Unit], in_order: bool = False) -> None:
        self._in_order = in_order
        self._blocks: dict[int, deque[Task]] = {}
        for unit in units:
            self._blocks.setdefault(unit.block, deque()).append(Task(unit, unit.scenes))
        self._home: dict[int, int] = {}

    def take(self, worker: int) -> Task | None:
        """Return the next task for a worker, or `None` when nothing waits."""
        if not self._blocks:
            return None
        home = min(self._blocks) if self._in_order else self._home.get(worker)
        if home not in self._blocks:
            taken = set(self._home.values())
            free = [block for block in self._blocks if block not in taken]
            home = max(
                free or self._blocks,
                key=lambda block: sum(len(task.scenes) for task in self._blocks[block]),
            )
            self._home[worker] = home
        waiting = self._blocks[home]
        task = waiting.popleft()
        if not waiting:
            del self._blocks[home]
        return task

    def put(self, tasks: Iterable[Task]) -> None:
        """Put tasks back, before everything else of their block."""
        for task in reversed(tuple(tasks)):
            self._blocks.setdefault(task.unit.block, deque()).appendleft(task)
