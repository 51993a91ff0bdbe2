"""Run a study into a folder, from wherever an earlier invocation left it."""

import logging
from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from faultpath.core.errors import Stopped, UserError
from faultpath.core.version import __version__
from faultpath.trials.arm import Arm, Study
from faultpath.trials.attempt import Reply
from faultpath.trials.checks import library_of
from faultpath.trials.code import Code
from faultpath.trials.execution.again import Rechecks
from faultpath.trials.execution.dispatch import Dispatch, block_limit_s
from faultpath.trials.execution.schedule import Schedule, Task, Unit, plan
from faultpath.trials.execution.state import Looks, RunState, Stop
from faultpath.trials.execution.worker import Job, run_here, run_task
from faultpath.trials.provenance import FlownAgain
from faultpath.trials.registry import load_system
from faultpath.trials.state import system_code
from faultpath.trials.store.folder import RunFolder
from faultpath.trials.store.manifest import Manifest
from faultpath.trials.store.tables import Trace, TrialAddress, traces_of
from faultpath.trials.system import System
from faultpath.trials.table import Deliveries, OutcomeTable, assemble, check_rows, selected
from faultpath.trials.work import Call, Executor, Progress, local

_log = logging.getLogger("faultpath")


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

    Raises:
        UserError: The folder or the study cannot be run.
        Stopped: Ctrl-C; everything finished is stored.
        Exception: An error of `faultpath.loop.taps`, when the audit itself is wrong.
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
    looks = Looks(study, library, units, stop)
    manifest = Manifest(
        faultpath_version=__version__,
        code=code.state,
        library_hash=library.content_hash,
        study=study,
    )
    run = RunFolder(Path(folder))
    state = RunState(units, run, Counter(row.arm.key() for row in study.rows))
    try:
        with run.open(manifest, notice, shared):
            schedule = Schedule(_missing(state, run, notice), study.look > 0)
            progress(state.progress())
            job = Job(study.system, study.library, code.state, library.content_hash)
            with held as workforce:
                there, here = partial(run_task, job), partial(run_here, system, code.unread())
                work = here if workforce.in_process else there

                def call(task: Task) -> Call:
                    return partial(work, task.unit.arm, task.scenes, task.recheck == "guarded")

                def take(worker: int) -> Task | None:
                    return None if looks.enough(state.outcomes) else schedule.take(worker)

                def settle(task: Task, reply: Reply) -> None:
                    schedule.put(state.settle(task, reply))

                limit_s = block_limit_s(system, time_limit_s)
                dispatch = Dispatch[Task](workforce, call, limit_s, study.system.name)
                dispatch.run(take, settle, lambda: progress(state.progress()))
                again = Rechecks(looks.units, run)
                if recheck:
                    waiting = list(again.tasks(state.outcomes))
                    dispatch.run(
                        lambda worker: waiting.pop(0) if waiting else None,
                        lambda task, reply: again.settle(task, reply, state.outcomes),
                    )
            table = assemble(looks.study, library, state.outcomes)
            taps, found = state.taps(looks.units), tuple(again.findings())
            deliveries = Deliveries.of(study, taps, table, found)
            digest = run.save_tables(table, deliveries)
            failures = _failures(looks.units, state, run)
    except KeyboardInterrupt:
        # What is on disk counts: the run may have been stopped between storing and noting.
        done = sum(bool(run.files_of(unit.key)) for unit in units)
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
