"""Run a plan into a folder, from wherever an earlier invocation left it."""

import logging
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from faultpath.core import __version__
from faultpath.core.errors import Stopped, UserError
from faultpath.run.attempt import Reply, attempt
from faultpath.run.code import Code, named
from faultpath.run.deliveries import Deliveries
from faultpath.run.execution.dispatch import Built, dispatch
from faultpath.run.execution.recheck import Rechecks, repeat
from faultpath.run.execution.state import Failure, RunState, Stop
from faultpath.run.findings import Finding, Recheck
from faultpath.run.plan import Plan, Task, TaskQueue, Unit, units_of
from faultpath.run.registry import load_system
from faultpath.run.store.folder import Manifest, RunFolder, check_same
from faultpath.run.trials import Trials
from faultpath.run.work.executor import Executor, Failed, Progress
from faultpath.run.work.processes import local
from faultpath.system.system import System

_log = logging.getLogger("faultpath")


@dataclass(frozen=True)
class RunResult:
    """A finished run."""

    trials: Trials
    deliveries: Deliveries
    """With what a reader of the results has to know."""
    blocks_computed: int
    blocks_kept: int
    failures: tuple[Failure, ...]
    outcomes_sha256: str
    system_fingerprint: str
    """Digest of `code`, shortened; for several runs together, of all of them."""
    code: tuple[Code, ...]
    """Code that ran, of each run that this is made of; none where other code had finished it."""
    library_hash: str
    rechecks: tuple[Recheck, ...] = ()
    """Trials that ran a second time, to see whether results repeat."""

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Results that do not repeat, readers that never read or that write, and the like."""
        return self.deliveries.findings


def run_plan(
    plan: Plan,
    folder: Path | str,
    workers: int = 2,
    progress: Callable[[Progress], None] = lambda report: None,
    notice: Callable[[str], None] = _log.warning,
    system: System | None = None,
    shared: bool = False,
    executor: Executor | None = None,
    time_limit_s: float | None = None,
    recheck: bool = True,
    stop: Stop | None = None,
) -> RunResult:
    """Run every treatment of a plan over its scenes, keeping what `folder` already holds.

    Args:
        plan: Treatments and scenes.
        folder: Run folder.
        workers: Worker processes; 0 runs in this one.
        progress: Called after each block and about twice a second.
        notice: Called with what a user should read, such as a damaged file or another process in
            the folder.
        system: Saves building it here when the caller has.
        shared: Lets plans with other treatments use the folder one after the other: a treatment
            that one of them ran is there for the next; the folder's tables are those of the last.
        executor: Runs trials in place of `workers` processes, and keeps its own for the next plan.
        time_limit_s: Seconds that a worker may take over one block, or one scene of a block that
            failed, before it is stopped; by default what the system says, or an hour.
        recheck: Runs a few scenes again and compares; see `RunResult.findings`.
        stop: Asked at each analysis of a plan that has some, and ends it; the result holds the
            scenes up to that analysis.

    Raises:
        UserError: The system cannot be built, or the folder cannot be used.
        Stopped: Ctrl-C; everything finished is stored.
        Exception: An error of `faultpath.loop.taps`, when the audit itself is wrong.
    """
    manager = local(workers) if executor is None else nullcontext(executor)
    if (workers if executor is None else executor.count) == 0 and time_limit_s is not None:
        raise UserError("a time limit needs worker processes: this one cannot stop itself")
    system = load_system(plan.system) if system is None else system
    built = Built.of(system, plan.system, plan.library)
    built.check_files()
    library, code = built.library, built.code
    manifest = mine = Manifest(
        faultpath_version=__version__,
        code=code.state,
        library_hash=library.content_hash,
        plan=plan,
    )
    run = RunFolder(Path(folder))
    units, earlier = _units(plan, built, manifest), run.made_by_other_code(manifest)
    try:
        with manager as workforce:
            work = partial(dispatch, workforce, built, _attempted, limit_s=time_limit_s)
            # A finished run of other code counts as it is once a sample of it repeats: else a
            # changed message would have all of its trials run again.
            if earlier:
                stored = _units(plan, built, earlier)
                keys, may_stop = ((unit.key, unit.scenes) for unit in stored), stop is not None
                if blocks := run.finished(keys, may_stop and plan.scenes_per_analysis > 0):
                    manifest, units = earlier, stored
                    changed = named(earlier.code.changed(code.state)) or "faultpath"
                    finished = [unit for unit in units if unit.key in blocks]
                    notice(repeat(blocks, finished, run, work, changed))
            state = RunState(plan, library, units, run, stop)
            with run.open(manifest, notice, shared):
                missing = state.resume(notice)
                if manifest is not mine and missing and not state.enough():
                    check_same(run.path, manifest, mine)  # which refuses trials of both codes
                queue = TaskQueue(missing, plan.scenes_per_analysis > 0)
                progress(state.progress())
                work(
                    lambda worker: None if state.enough() else queue.take(worker),
                    lambda task, reply: queue.put(state.take_in(task, reply)),
                    report=lambda: progress(state.progress()),
                )
                state.check_reached(system.control_dt_s)
                rechecks = Rechecks(state.units, state.outcomes, run)
                if recheck:
                    tasks = iter(rechecks.tasks(state.sound_units()))
                    work(lambda worker: next(tasks, None), rechecks.handle_reply)
                trials, findings = state.trials(), (*state.findings(), *rechecks.findings())
                deliveries = Deliveries.of(plan, state.taps(), trials, findings)
                digest = run.save_tables(trials, deliveries)
    except KeyboardInterrupt:
        # What is on disk counts: the run may have been stopped between storing and noting.
        done = len(run.list_shards().keys() & {unit.key for unit in units})
        raise Stopped(
            f"interrupted with {done} of {len(units)} blocks done and kept in {run.path}; run the "
            "same again to resume."
        ) from None
    return RunResult(
        trials=trials,
        deliveries=deliveries,
        blocks_computed=state.computed,
        blocks_kept=state.kept,
        failures=state.failures(),
        outcomes_sha256=digest,
        system_fingerprint=manifest.code.digest,
        code=(code,) if manifest.code == code.state else (),
        library_hash=library.content_hash,
        rechecks=rechecks.of_this_run(),
    )


def _units(plan: Plan, built: Built, manifest: Manifest) -> tuple[Unit, ...]:
    """Return the blocks that a plan takes, run by the code of `manifest`."""
    fingerprint = f"{manifest.faultpath_version} {manifest.code.digest}"
    block_size = built.system.scenes_a_block(len(built.library.scenes))
    return units_of(plan, built.library, block_size, fingerprint)


def _attempted(system: System, task: Task) -> Reply:
    reply = attempt(system, task.unit.treatment, task.scenes, task.recheck == "guarded")
    if isinstance(reply, Failed):
        raise reply.error  # not every error survives being sent as a value
    return reply
