"""For a package with much work of one kind, which worker processes share."""

from faultpath.run.work.executor import Lost, Returned, run_all, run_each, send_message
from faultpath.run.work.processes import local

__all__ = ["Lost", "Returned", "local", "run_all", "run_each", "send_message"]
