"""On what, when and how quietly a measurement of time was made."""

import os
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Self

from command import faultpath
from flown_code import ROOT
from pydantic import BaseModel

from faultpath.execution.provenance import checkout, processor

sys.path.insert(0, str(ROOT))
from benchmarks.quiet import Others, busy


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
        """Return the time that `faultpath` takes for these; exit with its status where it fails."""
        machine, others, began = Machine.here(package), Others(), time.monotonic()
        faultpath(*arguments)
        wall_s = time.monotonic() - began
        return cls(**machine.model_dump(), wall_s=wall_s, others=others.share())

    @property
    def took(self) -> str:
        """How long, when, on what and how quietly, as sentences can go on."""
        return f"{self.wall_s / 60:.0f} min {self.words}. {busy(self.others)}"
