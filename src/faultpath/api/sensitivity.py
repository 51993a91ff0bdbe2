"""`faultpath.sensitivity`: draw the errors that are declared, and see which of them matters."""

from os import PathLike
from pathlib import Path
from typing import Any

from faultpath.api.audit import run_folder
from faultpath.api.display import Display
from faultpath.api.folders import SENSITIVITY, SENSITIVITY_MADE_FROM
from faultpath.api.job import Job, asks, begin
from faultpath.api.runs import SensitivityRun
from faultpath.api.systems import executor_of
from faultpath.decisions.sensitivity.decide import conclude
from faultpath.decisions.sensitivity.study import plan_sensitivity
from faultpath.trials import System
from faultpath.trials.sensitivity_question import SensitivityQuestion
from faultpath.trials.store.atomic import write_text


@asks(SensitivityQuestion)
def sensitivity(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> SensitivityRun:
    """Tell which declared uncertainty moves what a variant achieves: Sobol indices of groups.

    One arm is one draw of all errors, each at all who read its source.

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
        "sensitivity", SensitivityQuestion, system, arguments, progress
    )
    plan = plan_sensitivity(chosen.system, chosen.spec, question, library)
    named = [
        plan.study.name,
        question.metric or "success",
        *question.fault,
        f"{question.points}-points-seed-{question.design_seed}",
        Path(question.library).stem,
    ]
    place = run_folder(question, chosen, named)
    trials = len(plan.study.arms()) * len(plan.study.scenes)
    display.say(
        f"{question.points} points of {len(plan.question.groups)} groups of sources: "
        f"{trials} trials at most."
    )
    with executor_of(chosen.system, chosen.workers, chosen.executor) as executor:
        job = Job(place, executor, display, {"time_limit_s": question.time_limit_s})
        with display.progress("Running") as show:
            result = job.run(plan.study, chosen.system, show)
        values, scenes = plan.values(result.outcomes)
        failed = len(result.outcomes.failed())
        record = conclude(plan.question, values, scenes, failed, result.findings)
        write_text(place / SENSITIVITY, record.model_dump_json(indent=1) + "\n", place)
        provenance = job.finish(result, chosen.system, SENSITIVITY_MADE_FROM)
    run = SensitivityRun(place, record, provenance)
    run.report()
    return run
