"""The state of a run: which units are done, what becomes of a reply, and where it may stop."""

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace

from faultpath.core.errors import UserError
from faultpath.loop import TapCount, added
from faultpath.trials.arm import Study
from faultpath.trials.attempt import Died, Done, Raised, Reply, Wrong
from faultpath.trials.declared import Library
from faultpath.trials.execution.schedule import Task, Unit
from faultpath.trials.outcome import Outcome, failed_outcome
from faultpath.trials.store.folder import RunFolder
from faultpath.trials.store.tables import Shard
from faultpath.trials.table import OutcomeTable, assemble
from faultpath.trials.work import Progress

FEW = 5
"""So many failed trials without one that ran to its end stop the study."""
Stop = Callable[[OutcomeTable], bool]
"""Says of the trials of all looks so far whether they are enough."""


class NothingRuns(UserError):
    """A system failed in all of the first trials: the rest would only repeat it."""


@dataclass
class _Partial:
    """A unit of which some scenes have an outcome."""

    outcomes: dict[str, Outcome] = field(default_factory=dict[str, Outcome])
    taps: tuple[TapCount, ...] = ()
    tracebacks: list[str] = field(default_factory=list[str])


class RunState:
    """Stores each unit as soon as all its scenes have an outcome."""

    def __init__(self, units: Iterable[Unit], folder: RunFolder, rows: Mapping[str, int]) -> None:
        """`rows`: in how many rows of the outcome table an arm's trials stand, by its key."""
        self.units = tuple(units)
        self.outcomes: dict[tuple[str, str], Outcome] = {}
        self.kept = self.computed = 0
        """Units that were stored before, and those that this invocation ran."""
        self._rows, self._folder = rows, folder
        self._taps: dict[str, tuple[TapCount, ...]] = {}
        self._partial: dict[str, _Partial] = {}
        self._began, self._ended = time.monotonic(), 0
        self._failed, self._sound = 0, False

    def keep(self, unit: Unit, shard: Shard) -> None:
        """Take over a unit that was done before."""
        self.kept += 1
        self._sound = True
        self._enter(unit, shard)

    def settle(self, task: Task, reply: Reply) -> tuple[Task, ...]:
        """Take in a reply and return the tasks that follow from it.

        A block whose program raised an error is run again scene by scene, so that only the scenes
        at fault are lost. A block over which a worker died is run again once, and then scene by
        scene too; one that took too long scene by scene at once. `Wrong` raises its error: nothing
        that follows would mean anything. `NothingRuns` after a few failures and no trial beside.
        """
        unit = task.unit
        match reply:
            case Wrong():
                raise reply.error
            case Done():
                outcomes, taps = reply.outcomes, reply.taps
                details = {o.scene: o.error or "" for o in outcomes if o.failed}
            case Died() if not task.retried and not reply.late:
                return (replace(task, retried=True),)
            case Died() | Raised() if len(task.scenes) > 1:
                return tuple(replace(task, scenes=(scene,)) for scene in task.scenes)
            case Raised() | Died():
                scene = next(iter(task.scenes))
                error = reply.error if isinstance(reply, Raised) else reply.how
                outcomes, taps = (failed_outcome(scene, error),), ()
                details = {scene: reply.traceback if isinstance(reply, Raised) else reply.how}
        partial = self._partial.setdefault(unit.key, _Partial())
        for scene, said in details.items():
            partial.tracebacks.append(f"{scene}: {unit.arm.model_dump_json()}\n{said}\n")
        partial.outcomes |= {outcome.scene: outcome for outcome in outcomes}
        partial.taps = added((*partial.taps, *taps))
        self._ended += len(outcomes)
        self._failed += len(details)
        self._sound = self._sound or len(details) < len(outcomes)
        tracebacks = "\n".join(sorted(partial.tracebacks))
        if self._failed >= FEW and not self._sound:
            self._folder.save_failure(unit.key, tracebacks)
            last = next(o for o in reversed(partial.outcomes.values()) if o.failed)
            raise NothingRuns(
                f"all of the first {self._failed} trials failed, and none ran to its end; in scene "
                f"{last.scene!r}: {' '.join((last.error or '').split())[:300]}. Mend the system "
                "and run the same again; the tracebacks are in "
                f"{self._folder.failures / unit.key}.txt"
            )
        if len(partial.outcomes) == len(unit.scenes):
            shard = Shard(tuple(partial.outcomes[scene] for scene in unit.scenes), partial.taps)
            self._folder.save_failure(unit.key, tracebacks)
            self._folder.save_shard(unit.key, shard)
            del self._partial[unit.key]
            self.computed += 1
            self._enter(unit, shard)
        return ()

    def _enter(self, unit: Unit, shard: Shard) -> None:
        key = unit.arm.key()
        self.outcomes.update(((key, outcome.scene), outcome) for outcome in shard.outcomes)
        self._taps[unit.key] = shard.taps

    def taps(self, units: Iterable[Unit]) -> dict[str, tuple[TapCount, ...]]:
        """Return what the taps did in units that are done, by the key of their arm."""
        counts: dict[str, list[TapCount]] = {}
        for unit in units:
            counts.setdefault(unit.arm.key(), []).extend(self._taps[unit.key])
        return {key: added(taps) for key, taps in counts.items()}

    def progress(self) -> Progress:
        """Return how far the run is, and how long it takes yet at the pace that it had."""
        trials = rows = done = rows_done = 0
        for unit in self.units:
            each, some = self._rows.get(unit.arm.key(), 1), len(unit.scenes)
            trials, rows = trials + some, rows + each * some
            if unit.key not in self._taps:
                partial = self._partial.get(unit.key)
                some = len(partial.outcomes) if partial else 0
            done, rows_done = done + some, rows_done + each * some
        left = None
        if self._ended:
            left = (trials - done) * (time.monotonic() - self._began) / self._ended
        return Progress(done, trials, f"{rows_done} of {rows} trials", left)


class Looks:
    """The looks of a study, taken in order, each as soon as all of its trials are there.

    So the same trials count whatever the number of workers, and wherever a run was interrupted.
    """

    def __init__(
        self, study: Study, library: Library, units: tuple[Unit, ...], stop: Stop | None
    ) -> None:
        self._study, self._library, self._units = study, library, units
        self._stop = stop if study.look else None
        self._missing: dict[int, set[tuple[str, str]]] = {}
        for unit in units:
            keys = self._missing.setdefault(unit.block, set())
            keys.update((unit.arm.key(), scene) for scene in unit.scenes)
        self._taken, self._over = 0, False

    def enough(self, outcomes: Mapping[tuple[str, str], Outcome]) -> bool:
        """Take the looks whose trials are all in `outcomes`; return whether the study stops."""
        while self._stop and not self._over and self._taken in self._missing:
            self._missing[self._taken].difference_update(outcomes)
            if self._missing[self._taken]:
                break
            self._taken += 1
            self._over = self._stop(assemble(self.study, self._library, outcomes))
        return self._over

    @property
    def study(self) -> Study:
        """The study, with the scenes of the looks that were taken."""
        if self._stop is None:
            return self._study
        scenes = self._study.scenes[: self._taken * self._study.look]
        return self._study.model_copy(update={"scenes": scenes})

    @property
    def units(self) -> tuple[Unit, ...]:
        """The units whose trials count."""
        if self._stop is None:
            return self._units
        return tuple(unit for unit in self._units if unit.block < self._taken)
