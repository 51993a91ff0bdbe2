"""On what, when and how quietly a measurement of time was made."""

import os
import resource
import subprocess
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Self

from pydantic import BaseModel

from faultpath.execution.provenance import checkout, processor

QUIET = 0.02
"""Share of the processor's time that other work may take of a measurement on a quiet machine."""

_STAT = Path("/proc/stat")


class Machine(BaseModel):
    """Where a measurement was made."""

    date: str
    processor: str
    cores: int
    commit: str | None
    dirty: bool | None

    @classmethod
    def here(cls, package: Path) -> Self:
        """Return this machine, and the commit of the checkout in which `package` lies."""
        commit, dirty = checkout(package)
        return cls(
            date=datetime.now(UTC).date().isoformat(),
            processor=processor(),
            cores=len(os.sched_getaffinity(0)),
            commit=commit,
            dirty=dirty,
        )

    @property
    def words(self) -> str:
        """When, on what and by which code, without a full stop."""
        changed = " with uncommitted changes" if self.dirty else ""
        return (
            f"on {self.date}: {self.processor}, {self.cores} cores, "
            f"commit `{(self.commit or 'unknown')[:12]}`{changed}"
        )


class Timed(Machine):
    """How long a command took there."""

    wall_s: float
    others: float
    """Share of the processor's time that other work took."""

    @classmethod
    def run(cls, package: Path, *arguments: str) -> Self:
        """Return the time that `faultpath` takes for these; `CalledProcessError` where it fails."""
        machine, others, began = Machine.here(package), Others(), time.monotonic()
        command = [str(Path(sys.executable).with_name("faultpath")), *arguments]
        subprocess.run(command, check=True)
        wall_s = time.monotonic() - began
        return cls(**machine.model_dump(), wall_s=wall_s, others=others.share())

    @property
    def took(self) -> str:
        """How long, when, on what and how quietly, as sentences can go on."""
        return f"{self.wall_s / 60:.0f} min {self.words}. {busy(self.others)}"


class Others:
    """Share of the processor that others take from here on (Linux)."""

    def __init__(self) -> None:
        self._busy, self._all = _ticks()
        self._own = _own_s()

    def share(self) -> float:
        """Return processor time of others since, over that of all cores."""
        taken, there = _ticks()
        own = (_own_s() - self._own) * os.sysconf("SC_CLK_TCK")
        return max(0.0, (taken - self._busy - own) / max(1.0, there - self._all))


def busy(share: float) -> str:
    """Return in a sentence what others took of the processor meanwhile."""
    said = f"ther work took {100 * share:.1f} % of the processor's time meanwhile."
    return f"O{said}" if share <= QUIET else f"**The machine was busy**: o{said}"


def _ticks() -> tuple[float, float]:
    """Return how long all cores together were busy, and how long they were there."""
    line = _STAT.read_text("ascii").partition("\n")[0]
    user, nice, system, idle, waiting, *interrupts = (float(word) for word in line.split()[1:])
    taken = user + nice + system + sum(interrupts[:2])
    return taken, taken + idle + waiting


def _own_s() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)
