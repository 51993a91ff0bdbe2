"""Where the arms of a study run, and how a run survives whatever happens to it."""

from faultpath.execution.attempt import WrongOutcomes
from faultpath.execution.ledger import Progress, ProgressCallback
from faultpath.execution.provenance import Stopwatch, run_provenance
from faultpath.execution.runner import Failure, Interrupted, RunResult, run_study

__all__ = [
    "Failure",
    "Interrupted",
    "Progress",
    "ProgressCallback",
    "RunResult",
    "Stopwatch",
    "WrongOutcomes",
    "run_provenance",
    "run_study",
]
