"""Shards of a pool."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from faultpath.quadrotor.platform import Platform
from faultpath.quadrotor.training.flight import fly
from faultpath.quadrotor.training.pool import encode_episodes, encode_rows
from faultpath.store import atomic


@dataclass(frozen=True)
class Shard:
    """Consecutive episodes of a pool, flown in one batch, and the folder of their two files."""

    folder: str
    pool: str
    seed: int
    first: int
    count: int
    platform: Platform

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
        flights = fly(self.pool, members, self.seed, self.platform)
        atomic.write(self.episodes, encode_episodes(members, flights))
        atomic.write(self.rows, encode_rows(members, flights))

    def _file(self, what: str) -> Path:
        return Path(self.folder) / f"{self.first:06d}+{self.count}.{what}.parquet"
