"""`faultpath.sensitivity`: draw the errors that are declared, and see which of them matters."""

from os import PathLike
from typing import Any

from faultpath.api.display import Display
from faultpath.api.job import asks
from faultpath.api.running import run
from faultpath.api.runs import SensitivityRun
from faultpath.decisions.sensitivity.study import plan_sensitivity
from faultpath.trials import System
from faultpath.trials.sensitivity_question import SensitivityQuestion


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
    return run(
        "sensitivity",
        SensitivityQuestion,
        plan_sensitivity,
        SensitivityRun,
        system,
        arguments,
        progress,
    )
