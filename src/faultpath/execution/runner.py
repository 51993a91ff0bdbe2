"""Run a study into a folder, from wherever an earlier invocation left it."""

import logging
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

import faultpath
from faultpath.code import Code, Watch
from faultpath.errors import UserError
from faultpath.execution.attempt import attempt
from faultpath.execution.changes import kept_trials, unnamed, watched
from faultpath.execution.crew import Crew
from faultpath.execution.ledger import Ledger, Progress, ProgressCallback
from faultpath.execution.limits import TimeLimit
from faultpath.execution.rechecks import Rechecks
from faultpath.execution.schedule import Recheck, Schedule, Task
from faultpath.execution.units import Unit, plan
from faultpath.execution.worker import Hello, Ready
from faultpath.record.provenance import FlownAgain
from faultpath.store.folder import RunFolder
from faultpath.store.manifest import Manifest
from faultpath.store.tables import Trace, TrialAddress, traces_of
from faultpath.trials.arm import Arm, Study
from faultpath.trials.checks import library_of
from faultpath.trials.deliveries import Deliveries
from faultpath.trials.registry import load_system
from faultpath.trials.state import system_code
from faultpath.trials.system import System
from faultpath.trials.table import OutcomeTable, assemble, check_rows, selected

_TICK_S = 0.5
_log = logging.getLogger("faultpath")


class Interrupted(Exception):
    """Ctrl-C stopped a run; everything finished is stored, and the same command resumes."""

    def __init__(self, done: int, total: int) -> None:
        super().__init__(f"interrupted with {done} of {total} blocks done")
        self.done = done
        self.total = total


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
    """What the taps did, row by row."""
    traces: Mapping[TrialAddress, Trace]
    """Position at each control step, `[T, 3]`, metres, world frame."""
    blocks_computed: int
    blocks_kept: int
    failures: tuple[Failure, ...]
    outcomes_sha256: str
    system_fingerprint: str
    """Of `code`, shortened; for several runs together, of all of them."""
    code: tuple[Code, ...]
    """What flew, of each run that this is made of."""
    library_hash: str
    flown_again: tuple[FlownAgain, ...] = ()
    """What was flown a second time, to see whether results repeat."""

    @property
    def findings(self) -> tuple[str, ...]:
        """What the run found that a reader has to know: results that do not repeat or depend on
        their block, consumers that never read or that write, hashes that prove nothing."""
        return self.deliveries.findings


def run_study(
    study: Study,
    folder: Path | str,
    workers: int = 2,
    progress: ProgressCallback | None = None,
    notice: Callable[[str], None] = _log.warning,
    system: System | None = None,
    shared: bool = False,
    crew: Crew | None = None,
    time_limit_s: float | None = None,
    recheck: bool = True,
) -> RunResult:
    """Run every arm of a study over its scenes, keeping what `folder` already holds.

    `workers` is the number of worker processes; 0 runs in this one. `progress` is called after
    each block and about twice a second; `notice` with what a user should read, such as a damaged
    file or another process in the folder. `system` saves building it here when the caller has.
    `shared` lets studies with other arms use the folder one after the other: an arm that one of
    them ran is there for the next; the folder's tables are those of the last. `crew` keeps the
    worker processes for the next study; without one they end with this. `time_limit_s` is how long
    a worker may take over one block (or one scene, when a block failed) before it is stopped, in
    seconds; by default many times as long as the slowest block so far took. `recheck` flies a
    few scenes of one block again and tells what differs; see `RunResult.findings`.

    Raises `UserError` for a folder or a study that cannot be run, `Interrupted` on Ctrl-C, and an
    error of `faultpath.taps` when the audit itself is wrong.
    """
    if workers < 0:
        raise UserError(f"the number of workers is {workers}: use 0 (this process) or more")
    if workers == 0 and time_limit_s is not None:
        raise UserError("a time limit needs worker processes: this one cannot stop itself")
    limit = TimeLimit(time_limit_s)
    system = load_system(study.system) if system is None else system
    library = library_of(system, study.library)
    code = system_code(system, study.system)
    fingerprint = code.state.digest
    scenes = selected(study, library)
    check_rows(study.rows, system.variants)
    units = plan(study.arms(), scenes, system.block_size, library, fingerprint)
    manifest = Manifest(
        faultpath_version=faultpath.__version__,
        code=code.state,
        library_hash=library.content_hash,
        study=study,
    )
    run = RunFolder(Path(folder))
    ledger = Ledger(units, run, workers, limit)
    report = progress or _ignore
    try:
        with run.open(manifest, notice, shared):
            schedule = _keep_finished(ledger, run, notice)
            report(ledger.progress())
            again = Rechecks(units, run)
            if workers == 0:
                _run_here(system, code.unread(), schedule, ledger, report)
                if recheck:
                    _recheck_here(system, again, ledger)
            elif schedule or (recheck and again.tasks(ledger.outcomes)):
                hello = Hello(study.system, study.library)
                expected = Ready(code.state, library.content_hash)
                with Crew() if crew is None else nullcontext(crew) as hands:
                    hands.begin(hello, expected, min(workers, max(1, len(schedule))))
                    _run_with(hands, schedule, ledger, report)
                    if recheck:
                        _recheck_with(hands, again, ledger)
                    if hands.undeclared:
                        notice(unnamed(sorted(hands.undeclared)))
            table = assemble(study, library, ledger.outcomes)
            deliveries = Deliveries.of(study, ledger.taps, table, again.findings())
            for finding in deliveries.findings:
                notice(finding)
            digest = run.save_tables(table, deliveries)
    except KeyboardInterrupt:
        # What is on disk counts: the ledger may have been stopped between storing and noting.
        done = sum(run.holds_shard(unit.key) for unit in units)
        raise Interrupted(done, len(units)) from None
    return RunResult(
        outcomes=table,
        deliveries=deliveries,
        traces=traces_of(table),
        blocks_computed=ledger.computed,
        blocks_kept=ledger.kept,
        failures=_failures(ledger, run),
        outcomes_sha256=digest,
        system_fingerprint=fingerprint,
        code=(code,),
        library_hash=library.content_hash,
        flown_again=again.flown(),
    )


def _keep_finished(ledger: Ledger, run: RunFolder, notice: Callable[[str], None]) -> Schedule:
    """Take over what is stored, say how much and from when, and return what is left to do.

    Trials that failed are left to do: what was wrong may have been the machine.
    """
    missing: list[Unit] = []
    again: list[Task] = []
    kept: list[str] = []
    for unit in ledger.units:
        shard = run.load_shard(unit.key, unit.scenes, notice)
        if shard is None:
            missing.append(unit)
        else:
            kept.append(unit.key)
            again += ledger.keep(unit, shard)
    if kept:
        notice(kept_trials(ledger.progress(), sum(len(t.scenes) for t in again), run.written(kept)))
    schedule = Schedule(missing)
    schedule.put(again)
    return schedule


def _run_here(
    system: System, unread: Watch, schedule: Schedule, ledger: Ledger, report: ProgressCallback
) -> None:
    while task := schedule.take(0):
        ledger.start(task)
        reply = watched(unread, attempt(system, task.unit.arm, task.scenes))
        schedule.put(ledger.settle(task, reply))
        report(ledger.progress())


def _run_with(crew: Crew, schedule: Schedule, ledger: Ledger, report: ProgressCallback) -> None:
    while ledger.done < len(ledger.units):
        for worker in crew.idle():
            if task := schedule.take(worker.number):
                ledger.start(task)
                worker.send(task)
        for task, reply in crew.replies(_TICK_S, ledger.limit):
            schedule.put(ledger.settle(task, reply))
        report(ledger.progress())


def _recheck_here(system: System, again: Rechecks, ledger: Ledger) -> None:
    while tasks := again.tasks(ledger.outcomes):
        for task in tasks:
            guard = task.recheck is Recheck.GUARDED
            reply = attempt(system, task.unit.arm, task.scenes, guard)
            again.settle(task, reply, ledger.outcomes)


def _recheck_with(crew: Crew, again: Rechecks, ledger: Ledger) -> None:
    while waiting := list(again.tasks(ledger.outcomes)):
        flying = 0
        while waiting or flying:
            for worker in crew.idle():
                if waiting:
                    worker.send(waiting.pop(0))
                    flying += 1
            for task, reply in crew.replies(_TICK_S, ledger.limit):
                again.settle(task, reply, ledger.outcomes)
                flying -= 1


def _failures(ledger: Ledger, run: RunFolder) -> tuple[Failure, ...]:
    failures: list[Failure] = []
    for unit in ledger.units:
        details = run.failures / f"{unit.key}.txt"
        for scene in unit.scenes:
            outcome = ledger.outcomes[unit.arm.key(), scene]
            if outcome.failed:
                where = details if details.exists() else None
                failures.append(Failure(unit.arm, scene, outcome.error or "", where))
    return tuple(failures)


def _ignore(progress: Progress) -> None:
    del progress
