"""Where the arms of a study run, and how a run survives whatever happens to it."""

# pyright: reportUnusedImport=false
from faultpath.trials.attempt import WrongOutcomes
from faultpath.trials.execution.provenance import Stopwatch, amend, run_provenance
from faultpath.trials.execution.runner import Failure, RunResult, run_study
