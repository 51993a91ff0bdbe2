"""The counterpart of a local worker process on a node of a Ray cluster."""

# Of Ray's types nothing is known.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
# pyright: reportUnknownArgumentType=false, reportMissingTypeStubs=false
import os
import socket
import sys
import warnings
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.reduction import ForkingPickler
from queue import SimpleQueue
from threading import Semaphore
from typing import Any

import ray

from faultpath.core import __version__
from faultpath.run.work.executor import live_on
from faultpath.run.work.processes import served, show

_ray: Any = ray


class OnNode:
    """An actor of Ray's: the counterpart of a local worker process.

    `folder` is the working directory of the driver, entered where the node has it too; `path`
    names folders that modules are looked for in beside the node's own.
    """

    def __init__(self, folder: str, path: Sequence[str]) -> None:
        if os.path.isdir(folder):
            os.chdir(folder)
        sys.path += [place for place in path if place not in sys.path]
        warnings.showwarning = show
        self._place = f"node {socket.gethostname()} of the Ray cluster"
        live_on(self._place)
        self._thread = ThreadPoolExecutor(1)  # always the same: some libraries bind to theirs

    def ready(self) -> tuple[str, str, str]:
        """Return where this is in words, the node's id, and the version of faultpath."""
        return self._place, _ray.get_runtime_context().get_node_id(), __version__

    def serve(self, packed: bytes) -> Iterator[bytes]:
        """Run a call; yield what it tells as it tells it, and its end last.

        What it tells has reached the driver before it goes on: Ray loses what a worker has only
        begun to send when it ends, and a call that ends it would not be known to have begun.
        """
        news: SimpleQueue[tuple[bytes, bool]] = SimpleQueue()
        taken = Semaphore(0)

        def on_message(message: object) -> None:
            news.put((bytes(ForkingPickler.dumps((message,))), False))
            taken.acquire()

        def run() -> None:
            try:
                news.put((bytes(served(packed, on_message)), True))
            except BaseException:  # as a process ends that cannot go on
                os._exit(1)

        self._thread.submit(run)
        last = False
        while not last:
            message, last = news.get()
            yield message  # until the driver has taken it: see `RayWorkers.submit`
            taken.release()
