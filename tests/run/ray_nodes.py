"""A Ray cluster of several nodes on this machine, small and quick to start."""

import os
import socket
from collections.abc import Generator
from contextlib import ExitStack, contextmanager
from typing import Any
from unittest.mock import patch

_PORTS = (
    "dashboard_agent_listen_port",
    "metrics_agent_port",
    "metrics_export_port",
    "runtime_env_agent_port",
)
_WITHOUT = {"include_dashboard": False, "include_log_monitor": False, "no_monitor": True}
"""Processes that nobody needs here, and that take their time to start."""
SMALL = {"num_cpus": 1, "object_store_memory": 100 * 2**20} | _WITHOUT


def node() -> dict[str, object]:
    """Arguments of a node; with its ports given it waits for fewer of its own processes."""
    with ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in _PORTS]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return SMALL | {
            name: each.getsockname()[1] for name, each in zip(_PORTS, sockets, strict=True)
        }


@contextmanager
def cluster() -> Generator[Any]:
    """Start a head with one CPU; `add_node(**node())` adds others. All end with the context."""
    from ray.cluster_utils import Cluster

    quiet = {"RAY_USAGE_STATS_ENABLED": "0", "RAY_memory_monitor_refresh_ms": "0"}
    with patch.dict(os.environ, quiet):
        started = Cluster(initialize_head=True, head_node_args=node())
        try:
            yield started
        finally:
            started.shutdown()
