"""Which units are done, and what becomes of a reply."""

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

from faultpath.execution.attempt import Died, Done, Raised, Reply, Wrong
from faultpath.execution.limits import FEW, NothingRuns, TimeLimit
from faultpath.execution.schedule import Task, Unit
from faultpath.store.folder import RunFolder
from faultpath.store.tables import Shard
from faultpath.taps import TapCount, added
from faultpath.trials.outcome import Outcome, failed_outcome


@dataclass(frozen=True)
class Progress:
    """How far a run is."""

    blocks_done: int
    blocks_total: int
    blocks_kept: int
    """Of those done, the ones that an earlier invocation left."""
    trials_done: int
    """Flown, each once, however many rows of the table it stands in."""
    trials_total: int
    rows_done: int
    """The same as trials of the outcome table, which is what all documents count."""
    rows_total: int
    trials_estimated: float
    """Trials done, plus the likely share of those that run now."""
    seconds_left: float | None
    """`None` until something can be known."""


ProgressCallback = Callable[[Progress], None]


class Standing:
    """The state of a run: stores each unit as soon as all its scenes have an outcome."""

    def __init__(
        self,
        units: Iterable[Unit],
        folder: RunFolder,
        workers: int,
        limit: TimeLimit | None = None,
        rows: Mapping[str, int] | None = None,
    ) -> None:
        """`rows`: in how many rows an arm's trials stand, by its key; one where nothing is said."""
        self.units = tuple(units)
        self._rows = {unit.key: (rows or {}).get(unit.arm.key(), 1) for unit in self.units}
        self._rows_done = 0
        self.outcomes: dict[tuple[str, str], Outcome] = {}
        self._taps: dict[str, tuple[TapCount, ...]] = {}
        self.kept = 0
        self.computed = 0
        self.limit = TimeLimit() if limit is None else limit
        self._folder = folder
        self._workers = workers
        self._partial: dict[str, dict[str, Outcome]] = {}
        self._partial_taps: dict[str, tuple[TapCount, ...]] = {}
        self._tracebacks: dict[str, list[str]] = {}
        self._running: dict[tuple[str, tuple[str, ...]], float] = {}
        self._seconds, self._timed_trials = 0.0, 0
        self._failed, self._sound = 0, False

    @property
    def done(self) -> int:
        """Units done."""
        return self.kept + self.computed

    def rows(self, unit: Unit) -> int:
        """Return in how many rows of the outcome table each trial of a unit stands."""
        return self._rows[unit.key]

    def keep(self, unit: Unit, shard: Shard) -> tuple[Task, ...]:
        """Take over a unit that was done before; return the task of its failed trials, if any."""
        failed = tuple(outcome.scene for outcome in shard.outcomes if outcome.failed)
        if not failed:
            self.kept += 1
            self._sound = True
            self._enter(unit, shard)
            return ()
        sound = tuple(outcome for outcome in shard.outcomes if not outcome.failed)
        self._sound = self._sound or bool(sound)
        self._partial[unit.key] = {outcome.scene: outcome for outcome in sound}
        self._partial_taps[unit.key] = shard.taps
        return (Task(unit, failed),)

    def start(self, task: Task) -> None:
        """Note that a task runs now."""
        self._running[task.unit.key, task.scenes] = time.monotonic()

    def settle(self, task: Task, reply: Reply) -> tuple[Task, ...]:
        """Take in a reply and return the tasks that follow from it.

        A block whose program raised an error is run again scene by scene, so that only the scenes
        at fault are lost. A block over which a worker died is run again once, and then scene by
        scene too; one that took too long scene by scene at once. `Wrong` raises its error: nothing
        that follows would mean anything. `NothingRuns` after a few failures and no trial beside.
        """
        self._running.pop((task.unit.key, task.scenes), None)
        match reply:
            case Wrong():
                raise reply.error
            case Done():
                self.limit.learn(reply.seconds, len(task.scenes))
                self._seconds += reply.seconds
                self._timed_trials += len(task.scenes)
                for outcome in reply.outcomes:
                    if outcome.failed:
                        self._note(task.unit, outcome.scene, outcome.error or "")
                return self._record(task.unit, reply.outcomes, reply.taps)
            case Died() if not task.retried and not reply.late:
                return (replace(task, retried=True),)
            case Died() | Raised() if len(task.scenes) > 1:
                return tuple(replace(task, scenes=(scene,)) for scene in task.scenes)
            case Raised():
                return self._fail(task, reply.error, reply.traceback)
            case Died():
                return self._fail(task, reply.how, reply.how)

    def taps(self, units: Iterable[Unit]) -> dict[str, tuple[TapCount, ...]]:
        """Return what the taps did in units that are done, by the key of their arm."""
        counts: dict[str, list[TapCount]] = {}
        for unit in units:
            counts.setdefault(unit.arm.key(), []).extend(self._taps[unit.key])
        return {key: added(taps) for key, taps in counts.items()}

    def progress(self) -> Progress:
        """Return how far the run is, with an estimate for the blocks that run now."""
        done = sum(map(len, self._partial.values())) + len(self.outcomes)
        total = sum(len(unit.scenes) for unit in self.units)
        estimated, left = float(done), None
        if self._timed_trials and self._seconds > 0:
            pace = self._seconds / self._timed_trials
            now = time.monotonic()
            for (_, scenes), since in self._running.items():
                estimated += min(0.95 * len(scenes), (now - since) / pace)
            left = (total - estimated) * pace / max(1, self._workers)
        rows = sum(self._rows[key] * len(part) for key, part in self._partial.items())
        return Progress(
            blocks_done=self.done,
            blocks_total=len(self.units),
            blocks_kept=self.kept,
            trials_done=done,
            trials_total=total,
            rows_done=self._rows_done + rows,
            rows_total=sum(self._rows[unit.key] * len(unit.scenes) for unit in self.units),
            trials_estimated=estimated,
            seconds_left=left,
        )

    def _fail(self, task: Task, error: str, details: str) -> tuple[Task, ...]:
        (scene,) = task.scenes
        self._note(task.unit, scene, details)
        return self._record(task.unit, (failed_outcome(scene, error),), ())

    def _note(self, unit: Unit, scene: str, details: str) -> None:
        text = f"{scene}: {unit.arm.model_dump_json()}\n{details}\n"
        self._tracebacks.setdefault(unit.key, []).append(text)

    def _record(
        self, unit: Unit, outcomes: Iterable[Outcome], taps: tuple[TapCount, ...]
    ) -> tuple[Task, ...]:
        partial = self._partial.setdefault(unit.key, {})
        for outcome in outcomes:
            partial[outcome.scene] = outcome
            self._sound = self._sound or not outcome.failed
            self._failed += outcome.failed
        if self._failed >= FEW and not self._sound:
            raise self._nothing_runs(unit, partial)
        counted = self._partial_taps[unit.key] = added(
            (*self._partial_taps.get(unit.key, ()), *taps)
        )
        if len(partial) == len(unit.scenes):
            shard = Shard(tuple(partial[scene] for scene in unit.scenes), counted)
            details = self._tracebacks.pop(unit.key, ())
            self._folder.save_failure(unit.key, "\n".join(sorted(details)))
            self._folder.save_shard(unit.key, shard)
            del self._partial[unit.key], self._partial_taps[unit.key]
            self.computed += 1
            self._enter(unit, shard)
        return ()

    def _nothing_runs(self, unit: Unit, partial: dict[str, Outcome]) -> NothingRuns:
        """Save what is known of the failures and say it in a sentence."""
        details = "\n".join(sorted(self._tracebacks.get(unit.key, ())))
        self._folder.save_failure(unit.key, details)
        last = next(o for o in reversed(partial.values()) if o.failed)
        said = " ".join((last.error or "").split())
        return NothingRuns(
            f"all of the first {self._failed} trials failed, and none ran to its end; in scene "
            f"{last.scene!r}: {said[:300]}. Mend the system and run the same again; the tracebacks "
            f"are in {self._folder.failures / unit.key}.txt"
        )

    def _enter(self, unit: Unit, shard: Shard) -> None:
        key = unit.arm.key()
        self.outcomes.update(((key, outcome.scene), outcome) for outcome in shard.outcomes)
        self._taps[unit.key] = shard.taps
        self._rows_done += self._rows[unit.key] * len(shard.outcomes)
