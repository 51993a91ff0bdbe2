"""Trials that runs share: shards under everything that decides them, in a folder beside the runs.

Nothing in it is needed: it holds copies, and may be deleted at any moment.
"""

import hashlib
import os
import platform
from collections.abc import Iterable
from importlib.metadata import distributions
from pathlib import Path

from faultpath.core.errors import UserError
from faultpath.core.files.opening import contents
from faultpath.trials.arm import SystemSpec
from faultpath.trials.store import atomic
from faultpath.trials.store.folder import RunFolder
from faultpath.trials.store.lock import Say, locked

_THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OPENBLAS_CORETYPE")


class SharedTrials:
    """Shards of many runs of one system on one machine.

    The key of a shard has code, data files, arm, scenes and library; the name of the folder has
    what a run folder leaves to whoever uses it: the system's name and options, what computes,
    every installed package, the machine.
    """

    def __init__(self, place: Path, spec: SystemSpec, backend: str) -> None:
        self.place = place
        self._held = RunFolder(place / _context(spec, backend))

    def lend(self, run: RunFolder, keys: Iterable[str]) -> int:
        """Copy the shards that `run` has not got into it, and return how many.

        They are compared with their digests when the run reads them, like its own.
        """
        absent = [key for key in keys if not run.holds_shard(key)]
        run.take_over(self._held, absent)
        return sum(map(run.holds_shard, absent))

    def keep(self, run: RunFolder, keys: Iterable[str], notice: Say) -> None:
        """Copy shards of `run` whose trials are sound; tell where another run's differ.

        A store that cannot be written is named and harms no run.
        """
        try:
            atomic.make_folder(self._held.shards)
            with locked(self._held.path, notice):
                atomic.sweep(self._held.shards)
                unlike = [key for key in keys if not self._keep(run, key)]
        except (OSError, UserError) as error:
            notice(f"Trials are not shared with other runs: {error}.")
            return
        if unlike:
            notice(
                f"{len(unlike)} blocks came out otherwise than in another run of the same code, "
                f"whose trials are in {self.place}: the system does not repeat. Delete that folder "
                "and find out why."
            )

    def _keep(self, run: RunFolder, key: str) -> bool:
        mine, *_ = run.files_of(key)
        data, place = contents(mine), self._held.shards / mine.name
        if any(path != place for path in self._held.files_of(key)):
            return False
        if not place.exists() or contents(place) != data:
            atomic.write(place, data, self._held.path)
            stat = mine.stat()
            os.utime(place, ns=(stat.st_atime_ns, stat.st_mtime_ns))  # when it was flown
        return True


def processor() -> str:
    """Return the model of the processor, as well as the platform tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    models = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(models, "") or platform.processor() or platform.machine()


def _context(spec: SystemSpec, backend: str) -> str:
    said = (
        spec.model_dump_json(),
        backend,
        platform.platform(),
        processor(),
        *(f"{name}={os.environ.get(name)}" for name in _THREADS),
        *sorted({f"{each.name}=={each.version}" for each in distributions()}),
    )
    return hashlib.sha256("\n".join(said).encode()).hexdigest()[:16]
