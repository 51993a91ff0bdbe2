"""Fly a little twice, to find results that do not repeat or that depend on their block.

A few scenes of a unit drawn at random are flown again without the others, and one scene of another
by itself, guarded. Only where that shows something more is flown, to tell the causes apart.
"""

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Literal

from pydantic import Field

from faultpath.code import named
from faultpath.execution.attempt import Reply, Wrong
from faultpath.execution.differences import difference, differing, findings, whole
from faultpath.execution.schedule import Recheck, Task, Unit
from faultpath.files.opening import LARGEST_TEXT, contents
from faultpath.files.plain import Misread, model_of
from faultpath.frozen import Frozen
from faultpath.record.provenance import FlownAgain
from faultpath.store.folder import RunFolder
from faultpath.taps import WrittenTo
from faultpath.trials.outcome import Outcome

Outcomes = Mapping[tuple[str, str], Outcome]
"""By arm key and scene."""

SAMPLE = 4
"""Scenes of a unit that are flown again."""


class _Kept(Frozen):
    """What `rechecks.json` holds."""

    format: Literal[3] = 3
    flown: tuple[FlownAgain, ...] = ()
    unnamed: dict[str, tuple[str, ...]] = Field(default_factory=dict[str, tuple[str, ...]])
    """Files that were read and that the system does not name, by the state of its code."""


class Rechecks:
    """What is flown again in a run, and what that found; kept in the run's folder.

    So are the files that were read and that the system, in the state `code`, does not name."""

    def __init__(self, units: Iterable[Unit], folder: RunFolder, code: str) -> None:
        self._units, self._code = tuple(units), code
        self._folder = folder
        before = _read(folder.rechecks)
        self._kept = {_name(each): each for each in before.flown}
        self._unnamed = dict(before.unnamed)

    def tasks(self, outcomes: Outcomes) -> tuple[Task, ...]:
        """Return what is to be flown again next of a run that is done; empty when nothing is left.

        It follows from the units' keys and from what the second flights so far have shown: the
        same run draws the same, whoever continues it.
        """
        sound = [
            unit
            for unit in self._units
            if not any(outcomes[unit.arm.key(), scene].failed for scene in unit.scenes)
        ]
        if not sound:
            return ()
        few = _few(self._drawn(sound))
        guarded = _guarded(sound, few.unit)
        alone = Task(guarded.unit, guarded.scenes, recheck=Recheck.ALONE)
        if left := self._left(few, guarded):
            return left
        if self._odd(guarded) and (left := self._left(alone)):
            return left
        part = next((task for task in (few, alone) if self._odd(task)), None)
        if part is None or part.scenes == part.unit.scenes:
            return ()
        return self._left(Task(part.unit, part.unit.scenes, recheck=Recheck.REPEAT))

    def settle(self, task: Task, reply: Reply, outcomes: Outcomes) -> None:
        """Compare what came of a second flight with the first; keep what that showed."""
        assert task.recheck is not None
        arm = task.unit.arm
        wrote = ""
        if isinstance(reply, Wrong) and isinstance(reply.error, WrittenTo):
            wrote = str(reply.error)
        first = [outcomes[arm.key(), scene] for scene in task.scenes]
        shown = FlownAgain(
            why=task.recheck.value,
            unit=task.unit.key,
            variant=arm.variant,
            faults=" and ".join(fault.describe() for fault in arm.faults) or "correct inputs",
            seed=arm.seed,
            scenes=task.scenes,
            unit_scenes=len(task.unit.scenes),
            wrote=wrote,
            differs="" if wrote else difference(first, reply),
            other=() if wrote else differing(first, reply),
        )
        self._kept[_name(shown)] = shown
        self._save()

    def note_unnamed(self, paths: Iterable[str]) -> None:
        """Keep files that were read and not named: when the run is resumed nothing reads them."""
        before = self._unnamed.get(self._code, ())
        found = tuple(sorted({*before, *paths}))
        if found != before:
            self._unnamed[self._code] = found
            self._save()

    def _save(self) -> None:
        flown = tuple(self._kept[name] for name in sorted(self._kept))
        kept = _Kept(flown=flown, unnamed=self._unnamed)
        self._folder.save_rechecks(f"{kept.model_dump_json(indent=1)}\n")

    def flown(self) -> tuple[FlownAgain, ...]:
        """Return what was flown again of the units of this run."""
        keys = {unit.key for unit in self._units}
        return tuple(shown for _, shown in sorted(self._kept.items()) if shown.unit in keys)

    def void(self) -> Iterator[tuple[Unit, str]]:
        """Yield the unit and scene of each trial that came out otherwise when its unit was asked
        for the same again: it says nothing, and no pair can be made of it."""
        units = {unit.key: unit for unit in self._units}
        for shown in self.flown():
            if whole(shown):
                yield from ((units[shown.unit], scene) for scene in shown.other)

    def findings(self) -> tuple[str, ...]:
        """Return the findings about units of this run, a sentence or two each."""
        unnamed = self._unnamed.get(self._code, ())
        return (*((_not_named(unnamed),) if unnamed else ()), *findings(self.flown()))

    def _drawn(self, sound: Sequence[Unit]) -> Unit:
        """Draw the unit whose scenes are flown again.

        Not the first arm of a block, where there are others: nothing was flown before it from
        which anything could have been kept. It has so many scenes that some are left out.
        """
        first = {unit.block: unit.key for unit in reversed(self._units)}
        follow = [unit for unit in sound if unit.key != first[unit.block]]
        return min(follow or sound, key=lambda unit: (len(unit.scenes) <= SAMPLE, _lot(unit.key)))

    def _left(self, *tasks: Task) -> tuple[Task, ...]:
        return tuple(task for task in tasks if self._shown(task) is None)

    def _odd(self, task: Task) -> bool:
        shown = self._shown(task)
        return shown is not None and bool(shown.differs or shown.wrote)

    def _shown(self, task: Task) -> FlownAgain | None:
        assert task.recheck is not None
        return self._kept.get((task.unit.key, task.recheck.value, task.scenes))


def _few(unit: Unit) -> Task:
    scenes = unit.scenes
    if len(scenes) > SAMPLE:
        by_lot = sorted(scenes[1:], key=lambda scene: _lot(unit.key, scene))[:SAMPLE]
        scenes = tuple(scene for scene in scenes if scene in by_lot)
    return Task(unit, scenes, recheck=Recheck.SAMPLE)


def _guarded(sound: Sequence[Unit], taken: Unit) -> Task:
    others = [unit for unit in sound if unit is not taken] or [taken]
    unit = min(others, key=lambda unit: (len(unit.scenes) == 1, _lot("guard", unit.key)))
    scene = min(unit.scenes[1:] or unit.scenes, key=lambda each: _lot(unit.key, each))
    return Task(unit, (scene,), recheck=Recheck.GUARDED)


def _name(shown: FlownAgain) -> tuple[str, str, tuple[str, ...]]:
    return shown.unit, shown.why, shown.scenes


def _lot(*parts: str) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _not_named(paths: Sequence[str]) -> str:
    """Say that a system reads files whose change nobody would notice."""
    return (
        f"The system reads {named(paths)}, not named in its data_files: a change there would not "
        "be noticed, and trials of before would be taken for trials of now."
    )


def _read(path: Path) -> _Kept:
    try:
        return model_of(contents(path, LARGEST_TEXT), _Kept)
    except (OSError, Misread):
        return _Kept()
