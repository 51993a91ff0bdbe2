"""Shards of a pool, and the worker processes that fly them."""

from __future__ import annotations

import json
import os
import selectors
import signal
import subprocess
import sys
import threading
from collections.abc import Generator, Sequence
from contextlib import ExitStack, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import IO

import torch

from faultpath.quadrotor.training.flight import FlightSettings, fly
from faultpath.quadrotor.training.pool import encode_episodes, encode_rows
from faultpath.store import atomic

_BOOT = "from faultpath.quadrotor.training.shards import serve; serve()"
_ONE_THREAD = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")


@dataclass(frozen=True)
class Shard:
    """Consecutive episodes of a pool, flown in one batch, and the folder of their two files."""

    folder: str
    pool: str
    seed: int
    first: int
    count: int

    @property
    def rows(self) -> Path:
        """The file with the rows. It is written last: the shard is done when it is there."""
        return self._file("rows")

    @property
    def episodes(self) -> Path:
        """The file with the episodes."""
        return self._file("episodes")

    def fly(self) -> None:
        """Fly the episodes and write both files; `OSError` when they cannot be written."""
        members = range(self.first, self.first + self.count)
        flights = fly(self.pool, members, self.seed, FlightSettings())
        atomic.write(self.episodes, encode_episodes(members, flights))
        atomic.write(self.rows, encode_rows(members, flights))

    def _file(self, what: str) -> Path:
        return Path(self.folder) / f"{self.first:06d}+{self.count}.{what}.parquet"


def fly_shards(shards: Sequence[Shard], workers: int) -> Generator[Shard, None, None]:
    """Fly shards and yield each when it is done; fewer than two workers are this process itself.

    Worker processes end with the iterator, in the middle of their work if need be. Raises
    `RuntimeError` when one ends by itself; it has said why on standard error.
    """
    if workers < 2:
        for shard in shards:
            shard.fly()
            yield shard
        return
    waiting = list(reversed(shards))
    with ExitStack() as stack:
        select = stack.enter_context(selectors.DefaultSelector())
        busy: dict[_Worker, Shard] = {}
        for _ in range(min(workers, len(shards))):
            worker = _Worker()
            stack.callback(worker.end)
            select.register(worker.replies, selectors.EVENT_READ, worker)
            busy[worker] = worker.hand(waiting.pop())
        while busy:
            for key, _ in select.select():
                worker: _Worker = key.data
                if not worker.replies.readline():
                    raise RuntimeError(f"a worker process ended while it flew {busy[worker]}")
                yield busy.pop(worker)
                if waiting:
                    busy[worker] = worker.hand(waiting.pop())


def serve() -> None:
    """Fly the shards that the parent names on standard input, one JSON object a line."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides what Ctrl-C means
    torch.set_num_threads(1)
    orders: SimpleQueue[str] = SimpleQueue()
    threading.Thread(target=_listen, args=(orders,), daemon=True).start()
    while True:
        Shard(**json.loads(orders.get())).fly()
        print(flush=True)


def _listen(orders: SimpleQueue[str]) -> None:
    """Pass orders on; end the process, in the middle of its work, when the parent is gone."""
    for line in sys.stdin:
        orders.put(line)
    os._exit(0)


class _Worker:
    """A process of one thread, started by command: the user's script is not imported again."""

    def __init__(self) -> None:
        path = os.pathsep.join(entry for entry in sys.path if entry)
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", _BOOT],
            env={**os.environ, **dict.fromkeys(_ONE_THREAD, "1"), "PYTHONPATH": path},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    @property
    def replies(self) -> IO[str]:
        """A line for each shard that is done; its end when the process has ended."""
        assert self._process.stdout is not None
        return self._process.stdout

    def hand(self, shard: Shard) -> Shard:
        """Give the process a shard to fly, and return it."""
        assert self._process.stdin is not None
        with suppress(BrokenPipeError):  # a process that ended shows when we read
            print(json.dumps(asdict(shard)), file=self._process.stdin, flush=True)
        return shard

    def end(self) -> None:
        """End the process now; what it has written is whole."""
        self._process.kill()
        with suppress(BrokenPipeError):
            self._process.communicate()
