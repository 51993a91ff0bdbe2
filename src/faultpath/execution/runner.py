"""Run a study into a folder, from wherever an earlier invocation left it."""

import logging
from collections import Counter
from collections.abc import Callable, Iterable
from contextlib import nullcontext
from datetime import datetime
from functools import partial
from pathlib import Path

from faultpath.errors import UserError
from faultpath.execution.attempt import Reply
from faultpath.execution.flying import Flying
from faultpath.execution.limits import TimeLimit, memory_limit
from faultpath.execution.looks import Looks, Stop
from faultpath.execution.machine import processor
from faultpath.execution.rechecks import Rechecks
from faultpath.execution.result import Failure, Interrupted, RunResult
from faultpath.execution.schedule import Recheck, Schedule, Task, Unit, plan
from faultpath.execution.standing import Progress, ProgressCallback, Standing
from faultpath.execution.worker import Brief, Order, fly, fly_here
from faultpath.store.folder import RunFolder
from faultpath.store.manifest import Manifest
from faultpath.store.shared import SharedTrials
from faultpath.store.tables import traces_of
from faultpath.trials.arm import Study
from faultpath.trials.checks import library_of
from faultpath.trials.deliveries import Deliveries
from faultpath.trials.outcome import failed_outcome
from faultpath.trials.registry import load_system
from faultpath.trials.state import system_code
from faultpath.trials.system import System
from faultpath.trials.table import assemble, check_rows, selected
from faultpath.version import __version__
from faultpath.work import Call, Executor, local

_log = logging.getLogger("faultpath")


_OTHERWISE = "it does not repeat: flown again in the same way, it came out otherwise"


def run_study(
    study: Study,
    folder: Path | str,
    workers: int = 2,
    progress: ProgressCallback | None = None,
    notice: Callable[[str], None] = _log.warning,
    system: System | None = None,
    shared: bool = False,
    executor: Executor | None = None,
    time_limit_s: float | None = None,
    memory_limit_gib: float | None = None,
    recheck: bool = True,
    stop: Stop | None = None,
    share: Path | None = None,
) -> RunResult:
    """Run every arm of a study over its scenes, keeping what `folder` already holds.

    `workers` is the number of worker processes; 0 runs in this one. `progress` is called after
    each block and about twice a second; `notice` with what a user should read, such as a damaged
    file or another process in the folder. `system` saves building it here when the caller has.
    `shared` lets studies with other arms use the folder one after the other: an arm that one of
    them ran is there for the next; the folder's tables are those of the last. `executor` flies in
    place of `workers` processes and keeps its own for the next study. `time_limit_s` is how long a
    worker may take over one block (or one scene, when a block failed) before it is stopped, in
    seconds; by default what the system says, or many times as long as the slowest block so far
    took. `memory_limit_gib` is how much a worker may take, in GiB; by default what the system says,
    or what there is. `recheck` flies a few scenes of one block again and tells what differs, see
    `RunResult.findings`; trials that do not repeat are void. What
    runs into other folders left in `share` of the same units, flown by the same code, is taken
    over, and what this one flew is left there, as far as it is sound; without `recheck` nothing is.
    `stop` is asked at each look of a study that has some, and ends it; the result holds the scenes
    up to that look.

    Raises `UserError` for a folder or a study that cannot be run, `Interrupted` on Ctrl-C, and an
    error of `faultpath.taps` when the audit itself is wrong.
    """
    hands = local(workers) if executor is None else nullcontext(executor)
    workers = workers if executor is None else executor.count
    for what, asked in (("time", time_limit_s), ("memory", memory_limit_gib)):
        if workers == 0 and asked is not None:
            raise UserError(f"a {what} limit needs worker processes: this one cannot stop itself")
    system = load_system(study.system) if system is None else system
    limit = TimeLimit(system.time_limit_s if time_limit_s is None else time_limit_s)
    memory_gib = memory_limit(memory_limit_gib, system.memory_limit_gib)
    library = library_of(system, study.library)
    code = system_code(system, study.system)
    fingerprint = code.state.digest
    scenes = selected(study, library)
    if study.look:
        scenes = sorted(scenes, key=lambda scene: study.scenes.index(scene.id))
    check_rows(study.rows, system.variants)
    units = plan(study.arms(), scenes, system.block_size, library, fingerprint, study.look)
    looks = Looks(study, library, units, stop)
    manifest = Manifest(
        faultpath_version=__version__,
        code=code.state,
        library_hash=library.content_hash,
        study=study,
    )
    run = RunFolder(Path(folder))
    rows = Counter(row.arm.key() for row in study.rows)
    standing = Standing(units, run, workers, limit, rows)
    report = progress or _ignore
    try:
        with run.open(manifest, notice, shared):
            store = _store(share, system, study)
            if store and (lent := store.lend(run, [unit.key for unit in units])):
                notice(
                    f"{lent} of {len(units)} blocks are those of other runs, of the same code on "
                    f"this machine, taken from {store.place}."
                )
            schedule = _keep_finished(standing, run, notice, study.look > 0)
            report(standing.progress())
            brief = Brief(study.system, study.library, code.state, library.content_hash, memory_gib)
            with hands as held:
                there, here = partial(fly, brief), partial(fly_here, system, code.unread())
                flown = here if held.in_process else there
                flying = Flying[Task](held, _orders(flown), limit, study.system.name)
                _run(flying, schedule, standing, looks, report)
                again = Rechecks(looks.units, run, code.state.digest)
                if recheck:
                    _recheck(flying, again, standing)
            for unit, scene in again.void():
                standing.outcomes[unit.arm.key(), scene] = failed_outcome(scene, _OTHERWISE)
            again.note_unnamed(flying.undeclared)
            table = assemble(looks.study, library, standing.outcomes)
            taps = standing.taps(looks.units)
            deliveries = Deliveries.of(study, taps, table, again.findings())
            for finding in deliveries.findings:
                notice(finding)
            digest = run.save_tables(table, deliveries)
            told = held.in_process or again.findings()
            if store and recheck and not told and (sound := _sound(looks.units, standing)):
                store.keep(run, sound, notice)
    except KeyboardInterrupt:
        # What is on disk counts: the run may have been stopped between storing and noting.
        done = sum(run.holds_shard(unit.key) for unit in units)
        raise Interrupted(done, len(units)) from None
    return RunResult(
        outcomes=table,
        deliveries=deliveries,
        traces=traces_of(table),
        blocks_computed=standing.computed,
        blocks_kept=standing.kept,
        failures=_failures(looks.units, standing, run),
        outcomes_sha256=digest,
        system_fingerprint=fingerprint,
        code=(code,),
        library_hash=library.content_hash,
        flown_again=again.flown(),
    )


def _store(share: Path | None, system: System, study: Study) -> SharedTrials | None:
    if share is None or study.system.is_object:
        return None
    return SharedTrials(share, study.system, system.backend, processor())


def _sound(units: Iterable[Unit], standing: Standing) -> list[str]:
    return [
        unit.key
        for unit in units
        if not any(standing.outcomes[unit.arm.key(), scene].failed for scene in unit.scenes)
    ]


def _keep_finished(
    standing: Standing, run: RunFolder, notice: Callable[[str], None], in_order: bool
) -> Schedule:
    """Take over what is stored, say how much and from when, and return what is left to do.

    Trials that failed are left to do: what was wrong may have been the machine.
    """
    missing: list[Unit] = []
    again: list[Task] = []
    kept: list[str] = []
    for unit in standing.units:
        shard = run.load_shard(unit.key, unit.scenes, notice)
        if shard is None:
            missing.append(unit)
        else:
            kept.append(unit.key)
            again += standing.keep(unit, shard)
    if kept:
        failed = sum(standing.rows(task.unit) * len(task.scenes) for task in again)
        notice(_kept_trials(standing.progress(), failed, run.written(kept)))
    schedule = Schedule(missing, in_order)
    schedule.put(again)
    return schedule


def _orders(fly: Callable[[Order], Reply]) -> Callable[[Task], Call]:
    return lambda task: partial(
        fly, Order(task.unit.arm, task.scenes, task.recheck is Recheck.GUARDED)
    )


def _run(
    flying: Flying[Task],
    schedule: Schedule,
    standing: Standing,
    looks: Looks,
    report: ProgressCallback,
) -> None:
    def take(worker: int) -> Task | None:
        if looks.enough(standing.outcomes):
            return None
        if task := schedule.take(worker):
            standing.start(task)
        return task

    def settle(task: Task, reply: Reply) -> None:
        schedule.put(standing.settle(task, reply))

    flying.run(take, settle, lambda: report(standing.progress()))


def _recheck(flying: Flying[Task], again: Rechecks, standing: Standing) -> None:
    def settle(task: Task, reply: Reply) -> None:
        again.settle(task, reply, standing.outcomes)

    while tasks := list(again.tasks(standing.outcomes)):
        flying.run(lambda _: tasks.pop(0) if tasks else None, settle, lambda: None)


def _failures(units: Iterable[Unit], standing: Standing, run: RunFolder) -> tuple[Failure, ...]:
    failures: list[Failure] = []
    for unit in units:
        details = run.failures / f"{unit.key}.txt"
        for scene in unit.scenes:
            outcome = standing.outcomes[unit.arm.key(), scene]
            if outcome.failed:
                where = details if details.exists() else None
                failures.append(Failure(unit.arm, scene, outcome.error or "", where))
    return tuple(failures)


def _kept_trials(now: Progress, again: int, written: tuple[datetime, datetime]) -> str:
    """Say how many trials an earlier invocation left, and from when they are."""
    first, last = (f"{moment:%Y-%m-%d %H:%M}" for moment in written)
    when = f"from {first}" if first == last else f"from {first} to {last}"
    tried = f"; {again} that failed are tried again" if again else ""
    return f"Kept {now.rows_done} of {now.rows_total} trials, {when} UTC{tried}."


def _ignore(progress: Progress) -> None:
    del progress
