"""Run a little twice, to find results that do not repeat or that depend on their block.

At the end of a run a few scenes of a unit drawn at random run again without the others, and one
scene of another by itself, with guarded readings. Of a finished run that other code made, whole
blocks run again, to see whether the code that is here repeats it.
"""

import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from faultpath.core.errors import SystemMistake, UserError
from faultpath.core.files.atomic import write_text
from faultpath.core.files.opening import LARGEST_TEXT, contents
from faultpath.core.files.plain import Misread, model_of
from faultpath.core.results import Frozen
from faultpath.loop import WrittenTo
from faultpath.run.attempt import Done, Reply
from faultpath.run.findings import Deviation, Recheck
from faultpath.run.plan import Task, Unit
from faultpath.run.store.folder import RunFolder
from faultpath.run.work.executor import Failed, Lost
from faultpath.system.outcome import Outcome

SAMPLE = 4
"""Scenes of a unit that run again."""
_OF_EACH = 4
"""Blocks of each variant that are repeated, under different conditions."""


def deviation(first: Sequence[Outcome], reply: Reply) -> Deviation | None:
    """Return how a second run of the same scenes differs; `None` where it is the same to the bit.

    Trajectories count where both runs have a hash of them.
    """
    scenes = tuple(outcome.scene for outcome in first)
    if isinstance(reply, Lost):
        return Deviation(died=reply.how, scenes=scenes, of=len(scenes))
    if not isinstance(reply, Done):
        return Deviation(raised=str(reply.error), scenes=scenes, of=len(scenes))
    gaps_by_scene = _gaps(first, reply)
    if not gaps_by_scene:
        return None
    largest: dict[str, float] = {}
    for gaps in gaps_by_scene.values():
        for name, gap in gaps.items():
            largest[name] = max(largest.get(name, gap), gap)
    largest.pop("status", None)
    return Deviation(
        scenes=tuple(gaps_by_scene),
        of=len(scenes),
        ended=sum("status" in gaps for gaps in gaps_by_scene.values()),
        gaps=tuple((name, gap if math.isfinite(gap) else None) for name, gap in largest.items()),
    )


def _gaps(first: Sequence[Outcome], again: Done) -> dict[str, dict[str, float]]:
    """Return by scene and name how far outcomes lie apart; infinity for what is no number."""
    gaps: dict[str, dict[str, float]] = {}
    for one, two in zip(first, again.outcomes, strict=True):
        mine: dict[str, Any] = {**vars(one), **one.metrics}
        theirs: dict[str, Any] = {**vars(two), **two.metrics}
        for name in dict.fromkeys((*mine, *theirs)):
            a: Any = mine.get(name)
            b: Any = theirs.get(name)
            unhashed = name == "trajectory_hash" and not (a and b)
            if name in ("metrics", "error") or unhashed or np.array_equal(a, b):
                continue
            numbers = isinstance(a, int | float) and isinstance(b, int | float)
            gaps.setdefault(one.scene, {})[name] = abs(a - b) if numbers else math.inf
    return gaps


class _Kept(Frozen):
    """Contents of `rechecks.json`."""

    format: Literal[5] = 5
    rechecks: tuple[Recheck, ...] = ()


class Rechecks:
    """Trials of a finished run that run again, and how they differ; kept in the run's folder.

    `outcomes` are those of `units`, by treatment key and scene.
    """

    def __init__(
        self, units: Sequence[Unit], outcomes: Mapping[tuple[str, str], Outcome], folder: RunFolder
    ) -> None:
        self._units, self._outcomes, self._folder = units, outcomes, folder
        kept = _Kept()
        with suppress(OSError, Misread):
            kept = model_of(contents(folder.rechecks, LARGEST_TEXT), _Kept)
        self._kept: dict[tuple[str, str | None, tuple[str, ...]], Recheck] = {
            (recheck.unit, recheck.why, recheck.scenes): recheck for recheck in kept.rechecks
        }

    def tasks(self, sound: Sequence[Unit]) -> tuple[Task, ...]:
        """Return what is to run again, of units without a failed trial; empty when nothing is left.

        It follows from the units' keys: the same run draws the same, whoever continues it.
        """
        if not sound:
            return ()
        # Not the first treatment of a block, where there are others: nothing ran before it from
        # which anything could have been kept. It has so many scenes that some are left out.
        first = {unit.block: unit.key for unit in reversed(self._units)}
        follow = [unit for unit in sound if unit.key != first[unit.block]]
        unit = min(
            follow or sound,
            key=lambda candidate: (len(candidate.scenes) <= SAMPLE, _hash_order(candidate.key)),
        )
        scenes = unit.scenes
        if len(scenes) > SAMPLE:
            drawn = sorted(scenes[1:], key=lambda scene: _hash_order(unit.key, scene))[:SAMPLE]
            scenes = tuple(scene for scene in scenes if scene in drawn)
        others = [candidate for candidate in sound if candidate is not unit] or [unit]
        guarded = min(
            others,
            key=lambda candidate: (len(candidate.scenes) == 1, _hash_order("guard", candidate.key)),
        )
        scene = min(
            guarded.scenes[1:] or guarded.scenes, key=lambda scene: _hash_order(guarded.key, scene)
        )
        tasks = (Task(unit, scenes, recheck="sample"), Task(guarded, (scene,), recheck="guarded"))
        return tuple(task for task in tasks if not self._compared(task))

    def _compared(self, task: Task) -> bool:
        """Return whether a second run of a task has shown something; one that failed may have been
        the machine's fault, and is tried again as failed trials are."""
        kept = self._kept.get((task.unit.key, task.recheck, task.scenes))
        if kept is None or kept.deviation is None:
            return kept is not None
        return not (kept.deviation.died or kept.deviation.raised)

    def handle_reply(self, task: Task, reply: Reply) -> None:
        """Compare what came of a second run with the first; keep what that showed.

        Raises an error that is none of the system's, such as of a file that changed under way.
        """
        assert task.recheck is not None
        if isinstance(reply, Failed) and not isinstance(reply.error, SystemMistake):
            raise reply.error
        treatment = task.unit.treatment
        # Results have to repeat here: that readings differ in a last bit with the number of scenes
        # in a call, as products of matrices do, is no reason to conclude nothing.
        first = [
            replace(self._outcomes[task.unit.treatment_key, scene], trajectory_hash="")
            for scene in task.scenes
        ]
        wrote = ""
        if isinstance(reply, Failed) and isinstance(reply.error, WrittenTo):
            wrote = str(reply.error)
        self._kept[task.unit.key, task.recheck, task.scenes] = Recheck(
            why=task.recheck,
            unit=task.unit.key,
            variant=treatment.variant,
            faults=treatment.describe(),
            seed=treatment.seed,
            scenes=task.scenes,
            unit_scenes=len(task.unit.scenes),
            wrote=wrote,
            deviation=None if wrote else deviation(first, reply),
        )
        kept = _Kept(rechecks=tuple(recheck for _, recheck in sorted(self._kept.items())))
        text = kept.model_dump_json(indent=1) + "\n"
        write_text(self._folder.rechecks, text, self._folder.path)

    def of_this_run(self) -> tuple[Recheck, ...]:
        """Return what ran again of the units of this run."""
        keys = {unit.key for unit in self._units}
        return tuple(recheck for _, recheck in sorted(self._kept.items()) if recheck.unit in keys)

    def findings(self) -> tuple[Recheck, ...]:
        """Return those of this run's units in which something was found."""
        return tuple(r for r in self.of_this_run() if r.wrote or r.deviation)


def repeat(
    blocks: Mapping[str, Done],
    units: Sequence[Unit],
    folder: RunFolder,
    work: Callable[[Callable[[int], Task | None], Callable[[Task, Reply], None]], None],
    changed: str,
) -> str:
    """Run a sample of the blocks of a finished run again and say how many trials they hold.

    The sample is always the same of the same run; `changed` is what changed since. `UserError`
    with the first block that differs.
    """
    tasks = [Task(unit, unit.scenes, recheck="sample") for unit in _sample(units)]
    queue = iter(tasks)

    def handle_reply(task: Task, reply: Reply) -> None:
        if isinstance(reply, Failed):
            raise reply.error
        treatment = task.unit.treatment
        if differs := deviation(blocks[task.unit.key].outcomes, reply):
            raise UserError(
                f"{folder.path} holds a finished run, and what is here does not repeat it (changed "
                f"since: {changed}): a block of {treatment.variant!r} ({treatment.describe()}, "
                f"seed {treatment.seed}, {len(task.scenes)} scenes from {task.scenes[0]!r}) "
                f"{differs}. "
                "Nothing in the folder was changed: choose a new one."
            )

    work(lambda worker: next(queue, None), handle_reply)
    count = sum(len(task.scenes) for task in tasks)
    return (
        f"{folder.path} was finished before {changed} changed. {count} of its trials ran again and "
        "are equal to the bit, so the run counts as it is."
    )


def _sample(units: Sequence[Unit]) -> list[Unit]:
    """Return a few units of each variant, under as many conditions as that gives."""
    sample: list[Unit] = []
    drawn = sorted(units, key=lambda unit: _hash_order(unit.key))
    for variant in sorted({unit.treatment.variant for unit in units}):
        of_variant = (unit for unit in drawn if unit.treatment.variant == variant)
        conditions = {repr(unit.treatment.faults): unit for unit in of_variant}
        sample += list(conditions.values())[:_OF_EACH]
    return sample


def _hash_order(*parts: str) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()
