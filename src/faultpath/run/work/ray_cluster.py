"""Workers on a Ray cluster: actors of one CPU each (`ray_node`)."""

# Of Ray's types nothing is known.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
# pyright: reportUnknownArgumentType=false, reportMissingTypeStubs=false
import math
import os
import pickle
import signal
import socket
import sys
import threading
import time
import warnings
from collections import Counter
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from multiprocessing.reduction import ForkingPickler
from typing import Any

import ray

from faultpath.core import __version__
from faultpath.core.errors import Notice, UserError
from faultpath.run.work.executor import (
    ONE_THREAD,
    Call,
    End,
    Executor,
    Lost,
    OnMessage,
    ignore,
)
from faultpath.run.work.processes import KEEP_MEMORY, passed_on
from faultpath.run.work.ray_node import OnNode

_ray: Any = ray
_FALSE_STARTS = 4
"""So often in a row a worker may end before it has begun; a node that is lost takes several."""
_PATIENCE_S = 30.0
"""Without a worker for so long, it is said what is waited for."""
_REPORTS = "RAY_USAGE_STATS_ENABLED"
_ENVIRONMENT = {
    **KEEP_MEMORY,
    **ONE_THREAD,
    # A worker asks Ray for a CPU only, and sees the GPUs that a process of the node would see.
    "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0",
}


class _WithoutNews:
    """Standard output, but for what Ray's threads print: news of workers is no output of ours."""

    def __init__(self, output: Any) -> None:
        self.output = output

    def __getattr__(self, name: str) -> Any:
        of_ray = threading.current_thread().name.startswith("ray_")
        return getattr(sys.stderr if of_ray else self.output, name)


@dataclass
class _Worker:
    actor: Any
    starting: Any
    """The reference of its first answer; `None` once that came."""
    place: str = "a node that it did not reach"
    stream: Any = None
    """Stream of what its call tells and returns; `None` without a call."""
    on_message: OnMessage = ignore


class RayWorkers(Executor):
    """Runs calls on a Ray cluster.

    `address` is `HOST:PORT` of its head, or empty for what Ray itself would take: `RAY_ADDRESS`,
    a cluster on this machine, else one of its own that ends with this. `count` is the number of
    workers; `None` for one for each CPU of the cluster.

    A number stands for an actor, which is free once it runs somewhere. One that is lost, with its
    node or alone, is asked for anew: Ray places it wherever there is a CPU, and until then the
    others work. Raises `UserError` where the cluster cannot be used.
    """

    def __init__(self, address: str = "", count: int | None = None) -> None:
        if count is not None and count < 1:
            raise UserError(
                f"the number of workers is {count}: on Ray use 1 or more, or leave it out for one "
                "a CPU"
            )
        self._ours = _connect(address, count)
        sys.stdout = self._stdout = _WithoutNews(sys.stdout)
        self.count = count or max(1, int(_ray.cluster_resources().get("CPU", 0)))
        self._nodes: set[str] = set()
        self._false_starts: Counter[int] = Counter()
        self._waits_for = "a free CPU, or for its processes to start"
        options = {"num_cpus": 1, "runtime_env": {"env_vars": _ENVIRONMENT}}
        self._kind = _ray.remote(OnNode).options(**options)
        self._workers = {number: self._started() for number in range(self.count)}

    def free(self) -> Sequence[int]:
        """Return the workers that run and have no call; wait for one where none has a call.

        As long as Ray does, which is for ever; a notice says what for.
        """
        notice_at = time.monotonic() + _PATIENCE_S
        while True:
            workers = self._workers.items()
            free = [n for n, worker in workers if worker.starting is None and worker.stream is None]
            if free or any(worker.stream is not None for _, worker in workers):
                return free
            for _ in self.completions(0.5):  # none has a call that could end
                pass
            if time.monotonic() > notice_at:
                text = f"no worker runs on the Ray cluster yet; waiting for {self._waits_for}."
                warnings.warn(Notice(text), stacklevel=1)
                notice_at = math.inf

    def submit(self, worker: int, call: Call, on_message: OnMessage = ignore) -> None:
        """Send the call to an actor that runs; its stream holds one item until it is taken."""
        chosen = self._workers[worker]
        assert chosen.starting is None
        assert chosen.stream is None
        serve = chosen.actor.serve.options(_generator_backpressure_num_objects=1)
        chosen.stream = serve.remote(bytes(ForkingPickler.dumps(call)))
        chosen.on_message = on_message

    def completions(self, timeout_s: float) -> Iterator[tuple[int, End]]:
        """Wait for the actors; one that was lost, or did not come up, is asked for anew."""
        awaited = {
            number: candidate.stream if candidate.starting is None else candidate.starting
            for number, candidate in self._workers.items()
            if candidate.starting is not None or candidate.stream is not None
        }
        refs = list(awaited.values())
        if not refs or not _ray.wait(refs, num_returns=1, timeout=timeout_s)[0]:
            return
        ready = {id(ref) for ref in _ray.wait(refs, num_returns=len(refs), timeout=0)[0]}
        for number in [number for number, ref in awaited.items() if id(ref) in ready]:
            worker = self._workers[number]
            if worker.starting is not None:
                self._welcome(number)
                continue
            try:
                # Of our own worker, through Ray, which itself runs what its cluster sends: no file.
                message: tuple[Any] | End = pickle.loads(_ray.get(next(worker.stream)))
            except _ray.exceptions.RayTaskError:
                raise
            except (_ray.exceptions.RayError, StopIteration) as error:
                message = Lost(f"the worker on {worker.place} was lost ({_last_line(error)})")
            if isinstance(message, tuple):
                passed_on(message, worker.on_message)
                continue
            worker.stream = None
            if isinstance(message, Lost):
                self.cancel(number)
            yield number, message

    def cancel(self, worker: int) -> None:
        """Kill the actor, which may only be out of reach, and ask for another."""
        _ray.kill(self._workers[worker].actor)
        self._workers[worker] = self._started()

    def close(self) -> None:
        """Kill the actors, and leave the cluster; one of our own ends."""
        for worker in self._workers.values():
            _ray.kill(worker.actor)
        self._workers.clear()
        if self._ours:
            with _as_before(), redirect_stdout(sys.stderr):
                _ray.shutdown()
        self._ours = False
        if sys.stdout is self._stdout:
            sys.stdout = self._stdout.output

    def _started(self) -> _Worker:
        own = (os.path.realpath(sys.prefix), os.path.realpath(sys.base_prefix))
        path = [
            folder for folder in sys.path if folder and not os.path.realpath(folder).startswith(own)
        ]
        actor = self._kind.remote(os.getcwd(), path)
        return _Worker(actor, actor.ready.remote())

    def _welcome(self, number: int) -> None:
        """Take in the first answer of an actor, or ask for another where it has not come up."""
        worker = self._workers[number]
        try:
            worker.place, node, version = _ray.get(worker.starting)
        except _ray.exceptions.OutOfMemoryError:  # of the node: Ray tries for ever as well
            self._waits_for = "memory: Ray stops workers while its node is almost full"
            self.cancel(number)
            return
        except _ray.exceptions.RayError as error:
            self._false_starts[number] += 1
            if self._false_starts[number] > _FALSE_STARTS:
                raise UserError(
                    f"workers do not start on the Ray cluster ({_last_line(error)}): every node "
                    "needs the same Python, and faultpath with its extra ray"
                ) from error
            self.cancel(number)
            return
        if version != __version__:
            raise UserError(
                f"{worker.place} has faultpath {version} and this process {__version__}: install "
                "the same version on every node"
            )
        worker.starting = None
        self._false_starts.clear()
        self._nodes.add(node)
        nodes = len(self._nodes)
        self.name = f"Ray {_ray.__version__}, {nodes} {'node' if nodes == 1 else 'nodes'}"


def _connect(address: str, count: int | None) -> bool:
    """Connect this process; return whether it was not before.

    Without an address, and where nothing runs here, a cluster of this machine alone starts, and
    ends with this process.
    """
    target = address or os.environ.get("RAY_ADDRESS", "")
    if _ray.is_initialized():
        cluster = _ray.get_runtime_context().gcs_address
        if address not in ("", "auto", cluster):
            raise UserError(
                f"this process is connected to the Ray cluster at {cluster}: name that one, or "
                "leave the address out"
            )
        return False
    if target not in ("", "auto"):  # tried first with a plain connection: Ray waits for minutes
        host, _, port = target.rpartition(":")
        try:
            if "/" in target:
                raise OSError("it is no HOST:PORT")
            socket.create_connection((host.strip("[]"), int(port)), 10.0).close()
        except (OSError, OverflowError, ValueError) as error:
            raise UserError(
                f"no Ray cluster answers at {target!r} ({error}): give HOST:PORT of its head, as "
                "in ray:10.0.0.1:6379, start one there with `ray start --head`, or send the "
                "command with `ray job submit` from a machine that does not belong to it"
            ) from error
    quiet = {"logging_level": "ERROR", "log_to_driver": False}
    with _as_before():
        try:
            _ray.init(address=target or "auto", **quiet)
        except (RuntimeError, ConnectionError) as error:  # other versions of Ray, or none there
            if target or isinstance(error, RuntimeError):
                where = target or "on this machine"
                raise UserError(
                    f"cannot use the Ray cluster {where}: {' '.join(str(error).split())[:300]}"
                ) from error
            # What comes back is small, and fetched at once.
            small = {"object_store_memory": 256 * 2**20, "include_dashboard": False}
            try:
                _ray.init(address="local", num_cpus=count, **small, **quiet)
            except Exception as late:  # of no narrower kind, when it does not come up in time
                raise UserError(f"Ray does not start on this machine: {_last_line(late)}") from late
    return True


@contextmanager
def _as_before() -> Generator[None]:
    """Keep the handler of SIGTERM; a cluster of our own reports nothing to Ray's makers."""
    main = threading.current_thread() is threading.main_thread()
    handler, setting = signal.getsignal(signal.SIGTERM), os.environ.get(_REPORTS)
    os.environ[_REPORTS] = setting or "0"
    try:
        yield
    finally:
        if main:
            signal.signal(signal.SIGTERM, handler)
        if setting is None:
            del os.environ[_REPORTS]


def _last_line(error: BaseException) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return (lines[-1] if lines else type(error).__name__)[:300].rstrip(".")
