"""For a package that does the same work many times: in worker processes, each part by itself."""

from faultpath.run.work.executor import Lost, Returned, run_all, run_each, send_message
from faultpath.run.work.processes import local

__all__ = ["Lost", "Returned", "local", "run_all", "run_each", "send_message"]
