"""`faultpath.search`: try faults in half of the scenes, and audit the best in the others."""

import hashlib
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from faultpath.api.audit import carry_out, run_folder
from faultpath.api.display import Display
from faultpath.api.folders import SEARCH, SEARCH_MADE_FROM, read_run
from faultpath.api.job import Job, asks, begin
from faultpath.api.runs import Run, SearchRun
from faultpath.api.systems import executor_of
from faultpath.decisions.search.decide import best, conclude
from faultpath.decisions.search.model import Tried
from faultpath.decisions.search.propose import proposals
from faultpath.decisions.search.study import SearchPlan, plan_search
from faultpath.trials import OutcomeTable, System
from faultpath.trials.question import SearchQuestion
from faultpath.trials.store.atomic import write_text


@asks(SearchQuestion)
def search(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> SearchRun:
    """Look for the fault that hurts those most who choose the repair by an isolated audit.

    Half of the scenes find it, and decide nothing; an ordinary audit of that one fault in the other
    half does.

    Args:
        system: As for `audit`.
        progress: As for `audit`.
        **arguments: ...

    The same call resumes, and ends with the same bytes.

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
        Stopped: Ctrl-C, or a notebook's stop button, ended it; the same call resumes.
    """
    question, chosen, library, display = begin(
        "search", SearchQuestion, system, arguments, progress
    )
    plan = plan_search(chosen.system, chosen.spec, question, library)
    bounds = _digest(plan.question.bounds.model_dump_json())
    named = [
        f"{plan.spec.name}-search-{question.repair}-vs-{question.baseline}",
        f"{question.within.stem}-{bounds}",
        f"{question.candidates}-faults-seed-{question.search_seed}",
        Path(question.library).stem,
    ]
    place = run_folder(question, chosen, named)
    with executor_of(chosen.system, chosen.workers, chosen.executor) as executor:
        run = _carry_out(
            plan, Job(place, executor, display, {"time_limit_s": question.time_limit_s})
        )
    run.report()
    return run


def _carry_out(plan: SearchPlan, job: Job) -> SearchRun:
    """Try faults, round after round, each from what those before have shown; audit the best, and
    write what the pages are made from.

    Raises `Stopped` on Ctrl-C, and `UserError` where the trials cannot be run.
    """
    question, display, tried = plan.question, job.display, dict[str, Tried]()
    bounds = question.bounds
    source = proposals(len(bounds.ranges()), question.search_seed, question.candidates)
    batch = [bounds.fault(point) for point in next(source)]
    if plan.system.backend:
        display.say(f"Computing with {plan.system.backend}.")
    per_fault = len(plan.study(batch[:1]).rows) * question.finding
    display.say(
        f"{question.candidates} faults are tried in {question.finding} scenes, {per_fault} trials "
        f"each at most; then one is put to the test in {question.confirming} other scenes."
    )

    def more(faults: Sequence[str], table: OutcomeTable) -> Sequence[str]:
        nonlocal batch
        while True:
            tried.update({f: plan.tried(f, table) for f in batch if f not in tried})
            try:
                points = source.send([tried[fault].regret_pp for fault in batch])
            except StopIteration:
                return ()
            batch = [bounds.fault(point) for point in points]
            if new := [fault for fault in dict.fromkeys(batch) if fault not in tried]:
                return new

    first = list(dict.fromkeys(batch))
    _, result = job.rounds(plan.system, first, plan.study, more, question.candidates, "faults")
    confirmed, folder, failed = None, "", len(result.outcomes.failed())
    if chosen := best(list(tried.values())):
        folder = f"confirmation-{_digest(chosen)}"
        display.say(f"Chosen: {chosen}. What follows decides.")
        audit = Job(job.folder / folder, job.executor, display, job.how)
        carry_out(plan.system, plan.audit(chosen), audit, signals=True)
        run = Run(audit.folder, *read_run(audit.folder))
        run.report()
        confirmed, failed = run.record, failed + run.failed
    record = conclude(question, list(tried.values()), confirmed, folder, failed, result.findings)
    write_text(job.folder / SEARCH, record.model_dump_json(indent=1) + "\n", job.folder)
    return SearchRun(job.folder, record, job.finish(result, plan.system, SEARCH_MADE_FROM))


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:8]
