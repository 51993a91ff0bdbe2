"""The state of a run: which units are done, what becomes of a reply, and where it may stop."""

import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from faultpath.core.errors import UserError
from faultpath.core.text import one_line
from faultpath.loop import TapCount, added, check_reached
from faultpath.run.attempt import Done, Raised, Reply
from faultpath.run.deliveries import TreatmentPart
from faultpath.run.findings import RaisedTogether
from faultpath.run.plan import Plan, Task, Unit, selected
from faultpath.run.store.folder import RunFolder
from faultpath.run.trials import Trial, Trials
from faultpath.run.work.executor import Failed, Lost, Progress
from faultpath.system.declared import Library, SceneRef
from faultpath.system.outcome import Outcome, failed_outcome

FEW = 5
"""So many failed trials, with none that ran to its end, stop the run."""
_WHOLE = "All scenes of the block at once: "
"""Begins the traceback of a block that raised an error, of which each scene is then run alone."""
Stop = Callable[[Trials], bool]
"""Says of the trials of all analyses so far whether they are enough."""


@dataclass(frozen=True)
class Failure:
    """A trial in which the program raised an error or died."""

    scene: str
    error: str
    details: Path | None
    """The file with the traceback, when there is one."""


@dataclass
class _Partial:
    """A unit of which some scenes have an outcome."""

    outcomes: dict[str, Outcome] = field(default_factory=dict[str, Outcome])
    taps: tuple[TapCount, ...] = ()
    tracebacks: list[str] = field(default_factory=list[str])


class RunState:
    """Stores each unit as soon as all its scenes have an outcome.

    The analyses of a plan are made in order, each as soon as all of its trials are there: the same
    trials count whatever the number of workers, and wherever a run was interrupted.
    """

    def __init__(
        self,
        plan: Plan,
        library: Library,
        units: tuple[Unit, ...],
        folder: RunFolder,
        stop: Stop | None,
    ) -> None:
        self.outcomes: dict[tuple[str, str], Outcome] = {}
        """By treatment key and scene."""
        self.kept = self.computed = 0
        """Units that were stored before, and those that this invocation ran."""
        self._plan, self._library, self._units, self._folder = plan, library, units, folder
        self._rows = Counter((row.treatment.key(), row.scenes) for row in plan.rows)
        self._taps: dict[str, tuple[TapCount, ...]] = {}
        self._partial: dict[str, _Partial] = {}
        self._began, self._ended = time.monotonic(), 0
        self._trials = sum(len(unit.scenes) for unit in units)
        self._in_rows = sum(len(u.scenes) * self._rows[u.treatment_key, u.part] for u in units)
        self._done = self._done_in_rows = 0
        """Trials with an outcome, and in how many of the rows' trials they stand."""
        self._failed, self._sound = 0, False
        self._stop = stop if plan.scenes_per_analysis else None
        self._analyses, self._over = 0, False
        self._batches: dict[int, set[str]] = {}
        """Keys of the units of each analysis."""
        for unit in units if self._stop else ():
            self._batches.setdefault(unit.block, set()).add(unit.key)

    def resume(self, notice: Callable[[str], None]) -> list[Unit]:
        """Take over what is stored, say how much and from when, and return what is left to do.

        Units with trials that failed are left to do: what was wrong may have been the machine.
        """
        missing: list[Unit] = []
        failed = 0
        for unit in self._units:
            shard = self._folder.load_shard(unit.key, unit.scenes, notice)
            unit_failed = sum(outcome.failed for outcome in shard.outcomes) if shard else 0
            failed += unit_failed
            if shard is None or unit_failed:
                missing.append(unit)
            else:
                self._enter(unit, shard)
                self._count(unit, len(unit.scenes))
        self.kept = len(self._taps)
        self._sound = self.kept > 0
        if self.kept or failed:
            tried = f"; {failed} that failed are tried again" if failed else ""
            when = ""
            if self.kept:
                written = self._folder.written(tuple(self._taps))
                first, last = (f"{moment:%Y-%m-%d %H:%M}" for moment in written)
                when = f", from {first}" + (f" to {last}" if first != last else "") + " UTC"
            notice(f"Kept {self.progress().count}{when}{tried}.")
        return missing

    def take_in(self, task: Task, reply: Reply) -> tuple[Task, ...]:
        """Take in a reply and return the tasks that follow from it.

        A block whose program raised an error, or that its worker did not outlive, is run again
        scene by scene, so that only the scenes at fault are lost. Raises the error of `Failed`,
        and `UserError` after a few failed trials and no other.
        """
        unit, taps = task.unit, tuple[TapCount, ...]()
        partial = self._partial.setdefault(unit.key, _Partial())
        match reply:
            case Done():
                outcomes, taps = reply.outcomes, reply.taps
                details = {o.scene: o.error or "" for o in outcomes if o.failed}
            case Lost() | Raised() if task.scenes[1:]:
                if isinstance(reply, Raised):
                    whole = f"{_WHOLE}{one_line(reply.error)}\n{reply.traceback}\n"
                    partial.tracebacks.append(whole)
                return tuple(replace(task, scenes=(scene,)) for scene in task.scenes)
            case Lost() | Raised():
                scene = task.scenes[0]
                error = reply.error if isinstance(reply, Raised) else reply.how
                outcomes = (failed_outcome(scene, error),)
                details = {scene: reply.traceback if isinstance(reply, Raised) else error}
            case Failed():
                raise reply.error
        for scene, detail in details.items():
            partial.tracebacks.append(f"{scene}: {unit.treatment.model_dump_json()}\n{detail}\n")
        partial.outcomes |= {outcome.scene: outcome for outcome in outcomes}
        self._count(unit, len(outcomes))
        partial.taps = added((*partial.taps, *taps))
        self._ended += len(outcomes)
        self._failed += len(details)
        self._sound = self._sound or len(details) < len(outcomes)
        tracebacks = "\n".join(sorted(partial.tracebacks))
        if self._failed >= FEW and not self._sound:
            self._folder.save_failure(unit.key, tracebacks)
            last = next(o for o in reversed(partial.outcomes.values()) if o.failed)
            raise UserError(
                f"all of the first {self._failed} trials failed, and none ran to its end; in scene "
                f"{last.scene!r}: {' '.join((last.error or '').split())[:300]}. Fix the system "
                "and run the same again; the tracebacks are in "
                f"{self._folder.failures / unit.key}.txt"
            )
        if len(partial.outcomes) == len(unit.scenes):
            shard = Done(tuple(partial.outcomes[scene] for scene in unit.scenes), partial.taps)
            self._folder.save_failure(unit.key, tracebacks)
            self._folder.save_shard(unit.key, shard)
            del self._partial[unit.key]
            self.computed += 1
            self._enter(unit, shard)
        return ()

    def findings(self) -> tuple[RaisedTogether, ...]:
        """Return what is wrong with a system whose trials end only when each runs alone."""
        texts = (self._folder.load_failure(unit.key) for unit in self.sound_units())
        errors = [text.partition("\n")[0] for text in texts if text.startswith(_WHOLE)]
        if not errors:
            return ()
        error = errors[0].removeprefix(_WHOLE)
        return (RaisedTogether(blocks=len(errors), of=len(self.units), error=error),)

    def failures(self) -> tuple[Failure, ...]:
        """Return the trials that failed, of the units that count."""
        failures: list[Failure] = []
        for unit in self.units:
            details = self._folder.failures / f"{unit.key}.txt"
            for scene in unit.scenes:
                outcome = self.outcomes[unit.treatment_key, scene]
                if outcome.failed:
                    place = details if details.exists() else None
                    failures.append(Failure(scene, outcome.error or "", place))
        return tuple(failures)

    def _enter(self, unit: Unit, shard: Done) -> None:
        self.outcomes.update(
            ((unit.treatment_key, outcome.scene), outcome) for outcome in shard.outcomes
        )
        self._taps[unit.key] = shard.taps

    def _count(self, unit: Unit, trials: int) -> None:
        self._done += trials
        self._done_in_rows += trials * self._rows[unit.treatment_key, unit.part]

    def enough(self) -> bool:
        """Take the analyses whose trials are all there; return whether the run stops."""
        while self._stop and not self._over:
            batch = self._batches.get(self._analyses)
            if batch is None or not self._taps.keys() >= batch:
                break
            self._analyses += 1
            self._over = self._stop(self.trials())
        return self._over

    def trials(self) -> Trials:
        """Return the trials that count, row by row of the plan: all, or those of the analyses that
        were made."""
        plan, scenes = self._plan, selected(self._plan, self._library)
        if self._stop:
            counted = set(plan.scenes[: self._analyses * plan.scenes_per_analysis])
            scenes = tuple(scene for scene in scenes if scene.id in counted)
        return Trials.of(self._counted(scenes))

    def _counted(self, scenes: Sequence[SceneRef]) -> Iterator[Trial]:
        for row in self._plan.rows:
            address, key = (row.variant, row.condition, row.seed), row.treatment.key()
            part = frozenset(row.scenes or self._plan.scenes)
            for scene in scenes:
                if scene.id in part:
                    outcome = self.outcomes[key, scene.id]
                    yield Trial(*address, scene.index, scene.topology, outcome)

    @property
    def units(self) -> tuple[Unit, ...]:
        """The units whose trials count."""
        return tuple(unit for unit in self._units if not self._stop or unit.block < self._analyses)

    def sound_units(self) -> list[Unit]:
        """Return the units that count and in which no trial failed."""
        return [
            unit
            for unit in self.units
            if not any(self.outcomes[unit.treatment_key, scene].failed for scene in unit.scenes)
        ]

    def taps(self) -> dict[TreatmentPart, tuple[TapCount, ...]]:
        """Return what the taps did in the units that count."""
        counts: dict[TreatmentPart, list[TapCount]] = {}
        for unit in self.units:
            counts.setdefault((unit.treatment_key, unit.part), []).extend(self._taps[unit.key])
        return {key: added(taps) for key, taps in counts.items()}

    def check_reached(self, dt_s: float) -> None:
        """Check that each fault reached its readers in one scene of its treatment or another.

        `dt_s` is the system's control step. Raises `NotDelivered`.
        """
        counts: dict[str, list[TapCount]] = {}
        last_steps: dict[str, list[int]] = {}
        for unit in self.units:
            key = unit.treatment_key
            counts.setdefault(key, []).extend(self._taps[unit.key])
            if unit.treatment.faults:
                ends = (self.outcomes[key, scene] for scene in unit.scenes)
                steps = (outcome.steps(dt_s) - 1 for outcome in ends if not outcome.failed)
                last_steps.setdefault(key, []).extend(steps)
        for key, steps in last_steps.items():
            check_reached(added(counts[key]), steps)

    def progress(self) -> Progress:
        """Return how far the run is, and how long it takes yet at the pace that it had."""
        left = None
        if self._ended:
            left = (self._trials - self._done) * (time.monotonic() - self._began) / self._ended
        count = f"{self._done_in_rows} of {self._in_rows} trials"
        return Progress(self._done, self._trials, count, left)
