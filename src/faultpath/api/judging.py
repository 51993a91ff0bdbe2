"""`faultpath.judge`: decide from trials that other tools ran, and write the run folder."""

import hashlib
import json
import re
from collections.abc import Sequence
from datetime import UTC, datetime
from os import PathLike
from pathlib import Path
from typing import Any, cast

import numpy as np

from faultpath.analyses.decide import decide
from faultpath.analyses.judging import PairedResults, pair_results
from faultpath.analyses.model import CORRECT, SHARED
from faultpath.api.audit import with_stored
from faultpath.api.display import Display, display
from faultpath.api.folders import MADE_FROM, RECORD, SYSTEM, as_text, read_provenance
from faultpath.api.job import Job, with_question_signature
from faultpath.api.runs import Run
from faultpath.core.errors import UserError
from faultpath.core.files.atomic import check_free, is_run, locked, make_folder, write_text
from faultpath.core.text import series
from faultpath.interface import Interface
from faultpath.report.inputs import ReportInput
from faultpath.run.deliveries import Deliveries, RowDeliveries
from faultpath.run.execution.runner import RunResult
from faultpath.run.provenance import PROVENANCE, amend
from faultpath.run.question import ask
from faultpath.run.received.question import JudgeQuestion
from faultpath.run.received.results import read_results
from faultpath.run.shown import SystemShown, VariantShown
from faultpath.run.store.folder import RunFolder
from faultpath.run.work.processes import local
from faultpath.system import declared


@with_question_signature(JudgeQuestion)
def judge(
    results: str | PathLike[str] | Sequence[str | PathLike[str]],
    *,
    progress: bool | Display = True,
    **arguments: Any,
) -> Run:
    """Compare two versions in trials that other tools ran, as an audit does in its own.

    Args:
        results: Files, or folders of them: named columns as CSV, Parquet or JSON lines, LeRobot's
            `eval_info.json`, logs of Inspect, samples of lm-eval. `mine=FILE` says which version
            all trials of a file are of, `mine@shared=FILE` under which condition too.
        progress: Whether notices are shown, on the standard error.
        **arguments: ...

    Raises:
        UserError: A file cannot be read, the trials cannot be paired, or nothing can be compared.
    """
    question = ask(JudgeQuestion, arguments, isinstance(progress, Display) and progress.is_command)
    named = [results] if isinstance(results, str | PathLike) else results
    if not _are_paths(named):
        raise UserError(f"results: {declared.shown(results)} is no path: give files or folders.")
    if not named:
        raise UserError("there are no results to judge: name a file.")
    fields = {"results": [str(path) for path in named], **question.model_dump(exclude_unset=True)}
    shown = display(progress, "judge", fields)
    started = datetime.now(UTC)
    rows, sources = read_results(named, question)
    paired = pair_results(rows, question)
    del rows  # as objects they take more memory than all that follows
    if notice := _modules_notice(paired, shown):
        shown.say(notice)
    folder = question.folder or _folder(paired, sources)
    _check_folder(folder)
    record = decide(
        paired.question, paired.facts, paired.conditions, paired.trials, paired.findings
    )
    make_folder(folder)
    record = with_stored(folder, record)
    with locked(folder, shown.say):
        (folder / PROVENANCE).unlink(missing_ok=True)  # of a judgement before, of other trials
        system = _system(paired.question)
        result = _stored(folder, paired, system)
        write_text(folder / RECORD, as_text(record), folder)
        job = Job(folder, local(0), shown, started=started)
        provenance = job.finish(result, MADE_FROM)
        # What was read stands where an audit names the data files that ran.
        code = provenance.code.model_copy(update={"data": sources})
        provenance = amend(folder, provenance.model_copy(update={"code": code}), MADE_FROM)
    run = Run(folder, ReportInput(record, provenance, system, paired.trials))
    run.report()
    return run


def _check_folder(folder: Path) -> None:
    """Raise `UserError` for the folder of a run that ran trials itself, of a damaged one, or with
    files of no run."""
    ran = (folder / "manifest.json").exists()
    if not ran and (folder / PROVENANCE).exists():
        ran = bool(read_provenance(folder).code.sources)
    if ran:
        raise UserError(f"{folder} holds a run that is no judgement: give another folder.")
    if not is_run(folder):
        check_free(folder)


def _are_paths(results: object) -> bool:
    """Return whether these are paths: a notebook may hand over anything."""
    several = cast("Sequence[object]", results) if isinstance(results, Sequence) else [results]
    return all(isinstance(path, str | PathLike) for path in several)


def _modules_notice(paired: PairedResults, shown: Display) -> str:
    """Say which conditions are taken for modules, where the shared one may be among them."""
    names = [condition.name for condition in paired.conditions if condition.name != CORRECT]
    if SHARED in names or len(names) < 2:
        return ""
    option = f"--shared {names[0]}" if shown.is_command else f"shared={names[0]!r}"
    modules = series([f"'{name}'" for name in names])
    return (
        f"No condition is named 'shared': {modules} are taken as modules; give {option} if it has "
        "the fault at every module."
    )


def _folder(paired: PairedResults, sources: dict[str, str]) -> Path:
    question = paired.question
    content = json.dumps(
        [sorted(sources.values()), question.model_dump(mode="json")], sort_keys=True
    )
    digest = hashlib.sha256(content.encode()).hexdigest()[:8]
    variants = re.sub(r"[^A-Za-z0-9.+,_-]+", "_", f"{question.repair}-vs-{question.baseline}")[:150]
    return Path("runs") / f"judged-{variants}-{digest}"


def _system(question: JudgeQuestion) -> SystemShown:
    """Return a system of which nothing is known but the names of two variants."""
    return SystemShown(
        control_dt_s=1.0,
        interface=Interface(name="results", sources=(), channels=()),
        variants=tuple(
            VariantShown(name=name, readers=(), bindings={})
            for name in (question.baseline, question.repair)
        ),
        plans={},
    )


def _stored(folder: Path, paired: PairedResults, system: SystemShown) -> RunResult:
    """Write the trials and what else pages are made from."""
    trials = paired.trials
    kinds, first = np.unique(trials.places[:, :3], axis=0, return_index=True)
    rows: list[list[int]] = kinds[np.argsort(first)].tolist()
    taps = tuple(
        RowDeliveries(
            variant=trials.variants[variant],
            condition=trials.conditions[condition],
            seed=trials.seeds[seed],
            taps=(),
        )
        for variant, condition, seed in rows
    )
    deliveries = Deliveries(rows=taps, findings=paired.findings)
    digest = RunFolder(folder).save_tables(trials, deliveries)
    write_text(folder / SYSTEM, as_text(system), folder)
    return RunResult(
        trials=trials,
        deliveries=deliveries,
        blocks_computed=0,
        blocks_kept=0,
        failures=(),
        outcomes_sha256=digest,
        system_fingerprint=digest[:16],
        code=(),
        library_hash=paired.facts.library_hash,
    )
