"""Run a study into a folder, from wherever an earlier invocation left it."""

import logging
import time
from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from faultpath.code import Code
from faultpath.errors import Stopped, UserError
from faultpath.execution.again import Rechecks
from faultpath.execution.schedule import Schedule, Task, Unit, plan
from faultpath.execution.state import Looks, RunState, Stop
from faultpath.execution.worker import Job, Started, run_here, run_task
from faultpath.record.provenance import FlownAgain
from faultpath.setup_limit import LONGEST_S, check_limit, setup_s, too_late
from faultpath.store.folder import RunFolder
from faultpath.store.manifest import Manifest
from faultpath.store.shared import SharedTrials
from faultpath.store.tables import Trace, TrialAddress, traces_of
from faultpath.trials.arm import Arm, Study
from faultpath.trials.attempt import Died, Reply, Wrong
from faultpath.trials.checks import library_of
from faultpath.trials.deliveries import Deliveries
from faultpath.trials.registry import load_system
from faultpath.trials.state import system_code
from faultpath.trials.system import System
from faultpath.trials.table import OutcomeTable, assemble, check_rows, selected
from faultpath.version import __version__
from faultpath.work import Call, Executor, Failed, Lost, Progress, WorkerLost, local

_log = logging.getLogger("faultpath")
_TICK_S = 0.5
_FALSE_STARTS = 4
"""So many workers in a row may die before they have built the system."""


@dataclass(frozen=True)
class Failure:
    """A trial in which the program raised an error or died."""

    arm: Arm
    scene: str
    error: str
    details: Path | None
    """The file with the traceback, when there is one."""


@dataclass(frozen=True)
class RunResult:
    """A finished run."""

    outcomes: OutcomeTable
    deliveries: Deliveries
    """What the taps did, row by row, and what a reader of the results has to know."""
    traces: Mapping[TrialAddress, Trace]
    """Position at each control step, `[T, 3]`, metres, world frame."""
    blocks_computed: int
    blocks_kept: int
    failures: tuple[Failure, ...]
    outcomes_sha256: str
    system_fingerprint: str
    """Of `code`, shortened; for several runs together, of all of them."""
    code: tuple[Code, ...]
    """What ran, of each run that this is made of."""
    library_hash: str
    flown_again: tuple[FlownAgain, ...] = ()
    """What ran a second time, to see whether results repeat."""

    @property
    def findings(self) -> tuple[str, ...]:
        """What the run found that a reader has to know: results that do not repeat, consumers that
        never read or that write, hashes that prove nothing."""
        return self.deliveries.findings


def run_study(
    study: Study,
    folder: Path | str,
    workers: int = 2,
    progress: Callable[[Progress], None] = lambda now: None,
    notice: Callable[[str], None] = _log.warning,
    system: System | None = None,
    shared: bool = False,
    executor: Executor | None = None,
    time_limit_s: float | None = None,
    recheck: bool = True,
    stop: Stop | None = None,
    share: Path | None = None,
) -> RunResult:
    """Run every arm of a study over its scenes, keeping what `folder` already holds.

    Args:
        study: Arms and scenes.
        folder: Run folder.
        workers: Worker processes; 0 runs in this one.
        progress: Called after each block and about twice a second.
        notice: Called with what a user should read, such as a damaged file or another process in
            the folder.
        system: Saves building it here when the caller has.
        shared: Lets studies with other arms use the folder one after the other: an arm that one of
            them ran is there for the next; the folder's tables are those of the last.
        executor: Runs trials in place of `workers` processes, and keeps its own for the next study.
        time_limit_s: Seconds that a worker may take over one block, or one scene of a block that
            failed, before it is stopped; by default what the system says, or an hour.
        recheck: Runs a few scenes again and compares; see `RunResult.findings`.
        stop: Asked at each look of a study that has some, and ends it; the result holds the scenes
            up to that look.
        share: Folder in which runs into other folders left trials of the same units, by the same
            code; they are taken over, and what this one ran is left there, as far as it is sound.

    Raises:
        UserError: The folder or the study cannot be run.
        Stopped: Ctrl-C; everything finished is stored.
        Exception: An error of `faultpath.taps`, when the audit itself is wrong.
    """
    held = local(workers) if executor is None else nullcontext(executor)
    workers = workers if executor is None else executor.count
    if workers == 0 and time_limit_s is not None:
        raise UserError("a time limit needs worker processes: this one cannot stop itself")
    system = load_system(study.system) if system is None else system
    library = library_of(system, study.library)
    code = system_code(system, study.system)
    scenes = selected(study, library)
    if study.look:
        scenes = sorted(scenes, key=lambda scene: study.scenes.index(scene.id))
    check_rows(study.rows, system.variants)
    units = plan(study.arms(), scenes, system.block_size, library, code.state.digest, study.look)
    keys = [unit.key for unit in units]
    looks = Looks(study, library, units, stop)
    manifest = Manifest(
        faultpath_version=__version__,
        code=code.state,
        library_hash=library.content_hash,
        study=study,
    )
    run = RunFolder(Path(folder))
    state = RunState(units, run, workers, Counter(row.arm.key() for row in study.rows))
    store = None
    if share is not None and not study.system.is_object:
        store = SharedTrials(share, study.system, system.backend)
    try:
        with run.open(manifest, notice, shared):
            if store and (lent := store.lend(run, keys)):
                notice(
                    f"{lent} of {len(units)} blocks are those of other runs, of the same code on "
                    f"this machine, taken from {store.place}."
                )
            schedule = Schedule(_missing(state, run, notice), study.look > 0)
            progress(state.progress())
            job = Job(study.system, study.library, code.state, library.content_hash)
            with held as hands:
                there, here = partial(run_task, job), partial(run_here, system, code.unread())
                work = here if hands.in_process else there

                def call(task: Task) -> Call:
                    return partial(work, task.unit.arm, task.scenes, task.recheck == "guarded")

                def take(worker: int) -> Task | None:
                    if looks.enough(state.outcomes):
                        return None
                    if task := schedule.take(worker):
                        state.start(task)
                    return task

                def settle(task: Task, reply: Reply) -> None:
                    schedule.put(state.settle(task, reply))

                limit_s = block_limit_s(system, time_limit_s)
                dispatch = Dispatch[Task](hands, call, limit_s, study.system.name)
                dispatch.run(take, settle, lambda: progress(state.progress()))
                again = Rechecks(looks.units, run)
                if recheck:
                    waiting = list(again.tasks(state.outcomes))
                    dispatch.run(
                        lambda worker: waiting.pop(0) if waiting else None,
                        lambda task, reply: again.settle(task, reply, state.outcomes),
                    )
            table = assemble(looks.study, library, state.outcomes)
            found = tuple(again.findings())
            deliveries = Deliveries.of(study, state.taps(looks.units), table, found)
            digest = run.save_tables(table, deliveries)
            failures = _failures(looks.units, state, run)
            if store and recheck and not hands.in_process and not found:
                bad = {(failure.arm.key(), failure.scene) for failure in failures}
                sound = [
                    unit.key
                    for unit in looks.units
                    if not any((unit.arm.key(), scene) in bad for scene in unit.scenes)
                ]
                store.keep(run, sound, notice)
    except KeyboardInterrupt:
        # What is on disk counts: the run may have been stopped between storing and noting.
        done = sum(run.holds_shard(key) for key in keys)
        raise Stopped(
            f"interrupted with {done} of {len(units)} blocks done and kept in {run.path}; run the "
            "same again to resume."
        ) from None
    return RunResult(
        outcomes=table,
        deliveries=deliveries,
        traces=traces_of(table),
        blocks_computed=state.computed,
        blocks_kept=state.kept,
        failures=failures,
        outcomes_sha256=digest,
        system_fingerprint=code.state.digest,
        code=(code,),
        library_hash=library.content_hash,
        flown_again=again.flown(),
    )


def block_limit_s(system: System, asked_s: float | None) -> float:
    """Return the seconds that a block may take: as asked, as the system says, or an hour."""
    check_limit(asked_s)
    return asked_s or system.time_limit_s or LONGEST_S


def _missing(state: RunState, run: RunFolder, notice: Callable[[str], None]) -> list[Unit]:
    """Take over what is stored, say how much and from when, and return what is left to do.

    Units with trials that failed are left to do: what was wrong may have been the machine.
    """
    missing: list[Unit] = []
    kept: list[str] = []
    failed = 0
    for unit in state.units:
        shard = run.load_shard(unit.key, unit.scenes, notice)
        lost = sum(outcome.failed for outcome in shard.outcomes) if shard else 0
        if shard is None or lost:
            missing.append(unit)
            failed += lost
        else:
            kept.append(unit.key)
            state.keep(unit, shard)
    if kept or failed:
        tried = f"; {failed} that failed are tried again" if failed else ""
        when = ""
        if kept:
            first, last = (f"{moment:%Y-%m-%d %H:%M}" for moment in run.written(kept))
            when = f", from {first}" + (f" to {last}" if first != last else "") + " UTC"
        notice(f"Kept {state.progress().count}{when}{tried}.")
    return missing


def _failures(units: tuple[Unit, ...], state: RunState, run: RunFolder) -> tuple[Failure, ...]:
    failures: list[Failure] = []
    for unit in units:
        details = run.failures / f"{unit.key}.txt"
        for scene in unit.scenes:
            outcome = state.outcomes[unit.arm.key(), scene]
            if outcome.failed:
                where = details if details.exists() else None
                failures.append(Failure(unit.arm, scene, outcome.error or "", where))
    return tuple(failures)


class Scened(Protocol):
    """Some scenes to run."""

    @property
    def scenes(self) -> tuple[str, ...]:
        """Scene ids."""
        ...


T = TypeVar("T", bound=Scened)


@dataclass
class _Running(Generic[T]):
    task: T
    since: float
    lost: int = 0
    """How many workers were lost over it."""
    started: bool = False
    """Whether the system was built; its building has a limit of its own."""


class Dispatch(Generic[T]):
    """Hands tasks to the workers of an executor, watches their time, and takes replies in.

    `call` is what runs a task, and tells `Started`; `limit_s` is how long one may take; `name` is
    that of the system.
    """

    def __init__(
        self, executor: Executor, call: Callable[[T], Call], limit_s: float, name: str
    ) -> None:
        self._executor, self._call, self._limit_s, self._name = executor, call, limit_s, name
        self._running: dict[int, _Running[T]] = {}
        self._again: list[tuple[T, int]] = []
        """Tasks whose worker was lost, through no fault of theirs that is known."""
        self._false_starts = 0

    def run(
        self,
        take: Callable[[int], T | None],
        settle: Callable[[T, Any], None],
        report: Callable[[], None] = lambda: None,
    ) -> None:
        """Run what `take` returns for a worker, until it returns nothing and all is settled.

        `settle` gets what the call returned, `Wrong` for an error that it raised, or `Died`.
        """
        while True:
            for worker in self._executor.free():
                task, lost = self._again.pop(0) if self._again else (take(worker), 0)
                if task is not None:
                    self._submit(worker, task, lost)
            if not self._running:
                return
            for worker, end in self._executor.completions(_TICK_S):
                running = self._running.pop(worker)
                if isinstance(end, Failed):
                    settle(running.task, Wrong(end.error))
                elif not isinstance(end, Lost):
                    settle(running.task, end.value)
                elif not running.started:
                    self._false_starts += 1
                    if self._false_starts > _FALSE_STARTS:
                        raise WorkerLost(f"worker processes do not come up: {end.how}")
                    self._again.append((running.task, running.lost))
                elif running.lost < self._executor.retries:
                    self._again.append((running.task, running.lost + 1))
                else:
                    settle(running.task, Died(end.how))
            now = time.monotonic()
            for worker, running in tuple(self._running.items()):
                allowed = self._limit_s if running.started else setup_s(self._limit_s)
                if now - running.since <= allowed:
                    continue
                if not running.started:
                    raise too_late(self._name, allowed, " in a worker process")
                self._executor.cancel(worker)
                del self._running[worker]
                how = f"it was stopped at the time limit of {allowed:g} s"
                settle(running.task, Died(how, late=True))
            report()

    def _submit(self, worker: int, task: T, lost: int) -> None:
        running = self._running[worker] = _Running(task, time.monotonic(), lost)

        def told(message: Started) -> None:
            running.started, running.since = True, time.monotonic()
            self._false_starts = 0

        self._executor.submit(worker, self._call(task), told)
