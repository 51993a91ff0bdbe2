"""Where the arms of a study run, and how a run survives whatever happens to it."""

# pyright: reportUnusedImport=false
from faultpath.execution.attempt import WrongOutcomes
from faultpath.execution.provenance import Stopwatch, run_provenance
from faultpath.execution.result import Failure, Interrupted, RunResult
from faultpath.execution.runner import run_study
from faultpath.execution.standing import Progress
