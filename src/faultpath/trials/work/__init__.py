"""Where work runs: a call goes out to a worker, and what it returns comes back."""

# pyright: reportUnusedImport=false
from faultpath.trials.work.executor import (
    Call,
    End,
    Executor,
    Failed,
    Here,
    Lost,
    Progress,
    Returned,
    WorkerLost,
    elsewhere,
    one_thread,
    run_all,
    run_each,
    tell,
)
from faultpath.trials.work.processes import Processes, local
