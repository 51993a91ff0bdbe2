"""Collects the pools of training episodes: batches on worker processes, shards that survive a kill.

`collect` is the entry. A shard is one batch of episodes; it depends on nothing but its recipe and
its place, so a run that was killed goes on where it was and ends with the same bytes.
"""

from __future__ import annotations

import hashlib
import json
import os
import selectors
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path

import torch

import faultpath
from faultpath.errors import UserError
from faultpath.execution.provenance import packages
from faultpath.quadrotor import wind
from faultpath.quadrotor.training import pool as pools_on_disk
from faultpath.quadrotor.training.flight import EPISODE_S, fly
from faultpath.quadrotor.training.pool import Provenance, Recipe
from faultpath.store import atomic
from faultpath.store.lock import locked

EPISODES = {"nominal": 7_150, "wind": 14_891}  # paper, Section IV-A
SHARD = 1024
"""Episodes flown together: the plant's cost a vehicle falls with the batch up to about here."""

Progress = Callable[[float, float], None]
"""Called with the vehicle-seconds done and those asked for; the first call counts what was kept."""

_BOOT = "from faultpath.quadrotor.training.collection import serve; serve()"
_ONE_THREAD = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")


@dataclass(frozen=True)
class Shard:
    """Some consecutive episodes of a pool and the folder that their files go to."""

    folder: str
    pool: str
    seed: int
    first: int
    count: int

    @property
    def rows(self) -> Path:
        """The file with the rows; it is written last."""
        return Path(self.folder) / f"{self.first:06d}+{self.count}.rows.parquet"

    @property
    def episodes(self) -> Path:
        """The file with the episodes."""
        return Path(self.folder) / f"{self.first:06d}+{self.count}.episodes.parquet"


def collect(
    folder: Path,
    pools: Sequence[str] = ("nominal", "wind"),
    workers: int = 2,
    episodes: Mapping[str, int] | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> dict[str, Path]:
    """Collect `pools` into `folder` and return the file of each pool.

    A pool that is there already is kept, one that was begun is finished. `episodes` gives the
    number of episodes of a pool where it is not the paper's. Raises `UserError` for a pool that
    does not exist or that was collected by another recipe, and when the folder cannot be written.
    """
    recipes = {name: recipe(name, (episodes or {}).get(name), seed) for name in pools}
    paths = {name: folder / f"{name}.parquet" for name in pools}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with locked(folder, lambda notice: print(notice, file=sys.stderr)):
            atomic.sweep(folder)
            missing = [name for name in pools if not _is_there(paths[name], recipes[name])]
            _fly_all({name: recipes[name] for name in missing}, folder, workers, progress)
            for name in missing:
                _assemble(paths[name], recipes[name])
    except OSError as error:
        raise UserError(
            f"cannot write to {folder} ({error.strerror}): choose a folder that you may write to "
            "and that has room."
        ) from error
    return paths


def recipe(pool: str, episodes: int | None = None, seed: int = 0) -> Recipe:
    """Return what decides a pool's numbers; `UserError` for a pool that does not exist."""
    if pool not in EPISODES:
        raise UserError(f"there is no pool '{pool}': choose from {', '.join(EPISODES)}.")
    return Recipe(
        pool=pool,
        episodes=EPISODES[pool] if episodes is None else episodes,
        seed=seed,
        wind=_wind_ranges() if pool == "wind" else {},
        code_sha256=pools_on_disk.code_sha256(),
    )


def serve() -> None:
    """Fly the shards that the parent names on standard input, one JSON object a line."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides what Ctrl-C means
    torch.set_num_threads(1)
    for line in sys.stdin:
        fly_shard(Shard(**json.loads(line)))
        print(flush=True)


def fly_shard(shard: Shard) -> None:
    """Fly a shard's episodes and write its two files."""
    members = range(shard.first, shard.first + shard.count)
    flights = fly(shard.pool, members, shard.seed, Recipe.model_fields["flight"].default)
    atomic.write(shard.episodes, pools_on_disk.encode_episodes(members, flights))
    atomic.write(shard.rows, pools_on_disk.encode_rows(members, flights))


def _wind_ranges() -> dict[str, float | tuple[float, float]]:
    return {
        "mean_mps": wind.POOL_MEAN_MPS,
        "turbulence_over_mean": wind.TURBULENCE_OVER_MEAN,
        "length_scale_m": wind.LENGTH_SCALE_M,
        "cruise_mps": wind.CRUISE_MPS,
        "gust_duration_s": wind.GUST_DURATION_S,
        "gust_over_mean": wind.GUST_OVER_MEAN,
        "gust_onset_s": wind.GUST_ONSET_S,
    }


def _is_there(path: Path, asked: Recipe) -> bool:
    """Whether `path` holds the pool that is asked for; `UserError` when it holds another one."""
    found = pools_on_disk.read_provenance(path)
    if found is None:
        return False
    for field in Recipe.model_fields:
        if getattr(found, field) != getattr(asked, field):
            raise UserError(
                f"{path} was collected with another '{field}': choose another folder, or delete "
                "it to collect it again."
            )
    return True


def _shards(asked: Recipe, folder: Path) -> list[Shard]:
    """Return a pool's shards, in a folder whose name changes with anything that decides them."""
    content = json.dumps([asked.model_dump(mode="json", exclude={"episodes"}), packages()])
    key = hashlib.sha256(content.encode()).hexdigest()[:16]
    place = folder / f".{asked.pool}-{key}"
    firsts = range(0, asked.episodes, SHARD)
    return [
        Shard(str(place), asked.pool, asked.seed, first, min(SHARD, asked.episodes - first))
        for first in firsts
    ]


def _fly_all(
    recipes: Mapping[str, Recipe], folder: Path, workers: int, progress: Progress | None
) -> None:
    shards = [shard for asked in recipes.values() for shard in _shards(asked, folder)]
    for shard in shards:
        Path(shard.folder).mkdir(exist_ok=True)
        atomic.sweep(Path(shard.folder))
    todo = [shard for shard in shards if not shard.rows.exists()]
    total = sum(shard.count for shard in shards)
    done = total - sum(shard.count for shard in todo)
    if progress is not None:
        progress(done * EPISODE_S, total * EPISODE_S)
    for shard in _run(todo, min(workers, len(todo))):
        done += shard.count
        if progress is not None:
            progress(done * EPISODE_S, total * EPISODE_S)


def _run(shards: Sequence[Shard], workers: int) -> Iterator[Shard]:
    """Fly shards and yield each as it is done; a single worker is this process itself."""
    if workers < 2:
        for shard in shards:
            fly_shard(shard)
            yield shard
        return
    waiting = list(reversed(shards))
    with ExitStack() as stack:
        select = stack.enter_context(selectors.DefaultSelector())
        busy: dict[subprocess.Popen[str], Shard] = {}
        for _ in range(workers):
            worker = stack.enter_context(_worker())
            stack.callback(_end, worker)
            select.register(worker.stdout, selectors.EVENT_READ, worker)
            busy[worker] = _hand(worker, waiting.pop())
        while busy:
            for key, _ in select.select():
                worker = key.data
                if not worker.stdout.readline():
                    raise RuntimeError(f"a worker ended while it flew {busy[worker]}")
                yield busy.pop(worker)
                if waiting:
                    busy[worker] = _hand(worker, waiting.pop())


def _worker() -> subprocess.Popen[str]:
    """Start a worker by command: one thread each, and the user's script is not imported again."""
    path = os.pathsep.join(entry for entry in sys.path if entry)
    return subprocess.Popen(
        [sys.executable, "-P", "-c", _BOOT],
        env={**os.environ, **dict.fromkeys(_ONE_THREAD, "1"), "PYTHONPATH": path},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def _hand(worker: subprocess.Popen[str], shard: Shard) -> Shard:
    assert worker.stdin is not None
    with suppress(BrokenPipeError):  # a worker that died shows when we read
        print(json.dumps(vars(shard)), file=worker.stdin, flush=True)
    return shard


def _end(worker: subprocess.Popen[str]) -> None:
    """End a worker in the middle of its work; what it has written whole stays."""
    worker.kill()
    with suppress(BrokenPipeError):
        worker.communicate()


def _assemble(path: Path, asked: Recipe) -> None:
    """Join a pool's shards into its files and remove them."""
    shards = _shards(asked, path.parent)
    rows = pools_on_disk.join(shard.rows.read_bytes() for shard in shards)
    episodes = pools_on_disk.join(shard.episodes.read_bytes() for shard in shards)
    steps = pools_on_disk.steps_of(episodes)
    provenance = Provenance(
        **dict(asked),
        faultpath_version=faultpath.__version__,
        packages=packages(),
        rows=int(steps.sum()) + len(steps),
        vehicle_seconds=pools_on_disk.vehicle_seconds(steps),
        ended_early=int((steps < steps.max()).sum()),
        rows_sha256=hashlib.sha256(rows).hexdigest(),
        episodes_sha256=hashlib.sha256(episodes).hexdigest(),
    )
    pools_on_disk.write_pool(path, rows, episodes, provenance)
    for leftover in path.parent.glob(f".{asked.pool}-*"):
        shutil.rmtree(leftover)
