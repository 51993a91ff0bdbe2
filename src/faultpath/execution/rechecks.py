"""Fly a little twice, to find results that do not repeat or that depend on their block.

A unit drawn at random is flown again, one scene is flown alone, and one with its readings guarded.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import cast

import numpy as np

from faultpath.execution.attempt import Died, Done, Raised, Reply, Wrong
from faultpath.execution.schedule import Recheck, Task
from faultpath.execution.units import Unit
from faultpath.store.folder import RunFolder
from faultpath.taps import WrittenTo
from faultpath.trials.outcome import Outcome

Outcomes = Mapping[tuple[str, str], Outcome]
"""By arm key and scene."""

_NUMBERS = ("time_s", "terminal_distance_m", "min_clearance_m", "struck_steps", "altered_steps")
_HASHES = ("initial_hash", "disturbance_hash", "planner_noise_hash")


class Rechecks:
    """What is flown again in a run, and what that found; kept in the run's folder."""

    def __init__(self, units: Iterable[Unit], folder: RunFolder) -> None:
        self._units = {unit.key: unit for unit in units}
        self._folder = folder
        self._found = _read(folder.rechecks)

    def tasks(self, outcomes: Outcomes) -> tuple[Task, ...]:
        """Return what is still to be flown again of a run that is done.

        The draw is by hash of the units' keys: the same run draws the same, whoever continues it.
        """
        sound = [
            unit
            for unit in self._units.values()
            if not any(outcomes[unit.arm.key(), scene].failed for scene in unit.scenes)
        ]
        if not sound:
            return ()
        unit = min(sound, key=lambda each: _lot(each.key))
        chosen = [Task(unit, unit.scenes, recheck=Recheck.REPEAT)]
        several = [(each, scene) for each in sound if len(each.scenes) > 1 for scene in each.scenes]
        if several:
            unit, scene = min(several, key=lambda each: _lot(each[0].key, each[1]))
            chosen.append(Task(unit, (scene,), recheck=Recheck.ALONE))
        unit, scene = min(
            ((each, each.scenes[0]) for each in sound), key=lambda each: _lot("guard", each[0].key)
        )
        chosen.append(Task(unit, (scene,), recheck=Recheck.GUARDED))
        return tuple(task for task in chosen if _name(task) not in self._found)

    def settle(self, task: Task, reply: Reply, outcomes: Outcomes) -> None:
        """Compare what came of a second flight with the first; keep what differs."""
        first = [outcomes[task.unit.arm.key(), scene] for scene in task.scenes]
        said = _judged(task, reply, first)
        self._found[_name(task)] = said
        text = json.dumps({"format": 1, "found": self._found}, indent=1, sort_keys=True) + "\n"
        self._folder.save_rechecks(text)

    def findings(self) -> tuple[str, ...]:
        """Return the findings about units of this run, a sentence or two each."""
        return tuple(
            said
            for name, said in sorted(self._found.items())
            if said and name.split()[1] in self._units
        )


def _judged(task: Task, reply: Reply, first: Sequence[Outcome]) -> str:
    arm = task.unit.arm
    faults = " and ".join(fault.describe() for fault in arm.faults) or "correct inputs"
    where = f"'{arm.variant}' under {faults}, seed {arm.seed}"
    if task.recheck is Recheck.GUARDED:
        if isinstance(reply, Wrong) and isinstance(reply.error, WrittenTo):
            return (
                f"A consumer writes into its reading, seen with {where}: {reply.error}. Without a "
                "fault that changes what others read, and with one it does not."
            )
        return ""
    differs = _difference(first, reply)
    if not differs:
        return ""
    if task.recheck is Recheck.REPEAT:
        return (
            f"Results do not repeat: {where}, flown twice over {len(first)} scenes, {differs}. "
            "Effects may be chance: look for random numbers that are not of faultpath.streams, "
            "for threads, and for what is kept from one call of run() to the next."
        )
    return (
        f"Results depend on the block: scene {task.scenes[0]!r} of {where}, flown alone, {differs} "
        f"from its flight among {len(task.unit.scenes)} scenes. Look for what scenes of one call "
        "of run() share."
    )


def _difference(first: Sequence[Outcome], reply: Reply) -> str:
    match reply:
        case Done():
            second = reply.outcomes
        case Raised():
            return f"failed the second time ({reply.error}), which differs"
        case Wrong():
            return f"failed the second time ({reply.error}), which differs"
        case Died():
            return f"could not be flown again ({reply.how}), which differs"
    pairs = [(one, two) for one, two in zip(first, second, strict=True) if not _same(one, two)]
    if not pairs:
        return ""
    scene = pairs[0][0].scene
    ends = sum(one.status is not two.status for one, two in pairs)
    parts = [f"{ends} end otherwise" if ends else "none ends otherwise"]
    gaps = {name: max(_gap(a, b, name) for a, b in pairs) for name in (*_NUMBERS, *_HASHES)}
    parts += [f"{name} by up to {gaps[name]:.3g}" for name in _NUMBERS if gaps[name]]
    parts += [f"{name} too" for name in _HASHES if gaps[name]]
    return f"differs in {len(pairs)} of {len(first)}, {scene!r} for one ({', '.join(parts)})"


def _gap(one: Outcome, two: Outcome, name: str) -> float:
    a, b = getattr(one, name), getattr(two, name)
    if a == b:
        return 0.0
    if isinstance(a, int | float) and isinstance(b, int | float):
        return abs(a - b)
    return float("inf")  # one of them has none, or they are hashes


def _same(one: Outcome, two: Outcome) -> bool:
    if one.status is not two.status or any(_gap(one, two, n) for n in (*_NUMBERS, *_HASHES)):
        return False
    if one.trace is None or two.trace is None:
        return one.trace is two.trace
    return np.array_equal(one.trace, two.trace)


def _name(task: Task) -> str:
    return " ".join((str(task.recheck), task.unit.key, task.scenes[0]))


def _lot(*parts: str) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _read(path: Path) -> dict[str, str]:
    """Return what was found before; a file that cannot be read is as good as none."""
    try:
        found = json.loads(path.read_bytes())["found"]
    except (OSError, ValueError, KeyError, TypeError):
        return {}
    if not isinstance(found, dict):
        return {}
    said = cast("dict[str, object]", found)
    return {k: v for k, v in said.items() if isinstance(v, str) and len(k.split()) >= 3}
