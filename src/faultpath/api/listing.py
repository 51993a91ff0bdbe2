"""What run folders there are, read as data: kind, verdict, trials."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from faultpath.api.run import open_run
from faultpath.core.errors import UserError
from faultpath.trials.store.parquet import Unreadable, rows_in


@dataclass(frozen=True)
class Listed:
    """A run folder, as it was found."""

    folder: str
    state: Literal["finished", "unfinished", "damaged"]
    words: str
    """The verdict of a finished run; of any other, what is there or what is wrong."""
    kind: str = ""
    """Audit, map or reproduction."""
    finished: str = ""
    """When it ended, in ISO 8601."""
    trials: int = 0
    """Of a finished run those in its outcome table; of another those stored so far."""


def runs(top: Path) -> tuple[Listed, ...]:
    """Return the runs in and below a folder, the latest first.

    A finished run is listed as that only if every file has the digest that it was left with.
    `UserError` for a folder that does not exist or holds no run.
    """
    if not top.is_dir():
        raise UserError(f"{top} is no folder: give one that holds runs.")
    found: list[Listed] = []
    for name, inside, files in os.walk(top):
        inside[:] = sorted(each for each in inside if not each.startswith("."))
        if "provenance.json" in files:
            found.append(_finished(Path(name)))
            inside.clear()
        elif "manifest.json" in files and "shards" in inside:
            found.append(_unfinished(Path(name)))
            inside.clear()
    if not found:
        raise UserError(
            f"{top} holds no provenance.json: give the folder of a finished run, or one that holds "
            "several."
        )
    return tuple(sorted(found, key=lambda each: each.finished, reverse=True))


def _finished(folder: Path) -> Listed:
    try:
        run = open_run(folder)
    except UserError as error:
        return Listed(str(folder), "damaged", str(error))
    provenance = run.provenance
    rows = rows_in(folder / "outcomes.parquet")
    return Listed(str(folder), "finished", run.headline, run.kind, provenance.finished, rows)


def _unfinished(folder: Path) -> Listed:
    kept = 0
    for shard in (folder / "shards").glob("*-*.parquet"):
        try:
            kept += rows_in(shard)
        except Unreadable:  # such a block is run again
            continue
    return Listed(str(folder), "unfinished", "The command that began it resumes it.", trials=kept)
