"""Where a run's numbers come from: code, machine and command, with digests of the run's files.

A run folder may come from anybody and may have been edited by anybody: whoever reads one compares
every file that its provenance names, and parses the very bytes that were compared.
"""

import platform
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, StringConstraints

from faultpath.core import __version__
from faultpath.core.errors import UserError
from faultpath.core.files.atomic import write_text
from faultpath.core.files.opening import LARGEST_TEXT, contents, read_regular
from faultpath.core.files.plain import model_of
from faultpath.core.results import Frozen, Result
from faultpath.core.trees import packages, release
from faultpath.run.findings import Recheck
from faultpath.run.work.executor import Executor

if TYPE_CHECKING:
    from faultpath.run.execution.runner import RunResult

PROVENANCE = "provenance.json"
AGAIN = "run it again, into a new folder"
"""Advice for a folder that is not as its run left it."""

FileName = Annotated[str, StringConstraints(pattern=r"^[a-z_]+\.[a-z]+$")]
Sha256 = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]


class RunCode(Frozen):
    """Code and data that ran."""

    faultpath_version: str
    commit: str | None
    """Commit of faultpath's own checkout."""
    dirty: bool | None
    system_fingerprint: str
    """Hash of the sources, data files and packages at the time, and of what the system says."""
    system_commit: str | None = None
    """Commit of the repository in which the system's file is tracked."""
    system_dirty: bool | None = None
    """Whether a file that ran differs from that commit."""
    sources: dict[str, str] = Field(default_factory=dict[str, str])
    """SHA-256 of each package that ran, and of each source in a folder of the user's."""
    data: dict[str, str] = Field(default_factory=dict[str, str])
    """SHA-256 of each data file that the system names."""


class RunMachine(Frozen):
    """Machine on which the code ran."""

    python: str
    packages: dict[str, str]
    platform: str
    processor: str
    backend: str = ""
    """Name of what computed the trials, where a system says so."""
    workers: int
    executor: str = ""
    """On what they were, where that is not this machine; platform and processor are this one's."""


class RunProvenance(Result):
    """The conditions under which a run was made; written as `provenance.json`."""

    command: tuple[str, ...]
    code: RunCode
    machine: RunMachine
    started: str
    finished: str
    wall_s: float
    """Wall time of the last invocation; shards kept from earlier ones are not counted."""
    blocks_computed: int
    blocks_kept: int
    library_hash: str
    rechecks: tuple[Recheck, ...] = ()
    """Trials that ran a second time, to see whether results repeat."""
    files: dict[FileName, Sha256] = Field(default_factory=dict[str, str])
    """The files beside this one that a report is made from, so that a change of one is seen."""


def run_provenance(
    folder: Path,
    names: Iterable[str],
    result: "RunResult",
    started: datetime,
    command: Sequence[str],
    executor: Executor,
    backend: str = "",
) -> RunProvenance:
    """Describe the run that has just finished on `executor`, and write that into its folder.

    `names` are the files there that its pages are made from; their digests stand beside it. Of a
    run that other code had finished, the provenance stays.
    """
    if not result.code and (folder / PROVENANCE).exists():
        earlier = model_of(contents(folder / PROVENANCE, LARGEST_TEXT), RunProvenance)
        return amend(folder, earlier, names)
    package = Path(__file__).parents[1] / "__init__.py"
    commit, dirty = checkout(package, [package.parent])
    system_commit, system_dirty = None, None
    if result.code and (main := result.code[0].main):
        files = (*result.code[0].sources, *result.code[0].data.values())
        system_commit, system_dirty = checkout(main, files)
    used = {name for code in result.code for name in code.imports}
    imported = {n.replace("_", "-"): version for n in sorted(used) if (version := release(n))}
    finished = datetime.now(UTC)
    provenance = RunProvenance(
        command=tuple(command),
        code=RunCode(
            faultpath_version=__version__,
            commit=commit,
            dirty=dirty,
            system_fingerprint=result.system_fingerprint,
            system_commit=system_commit,
            system_dirty=system_dirty,
            sources={name: of for code in result.code for name, of in code.state.files.items()},
            data={name: of for code in result.code for name, of in code.state.data.items()},
        ),
        machine=RunMachine(
            python=platform.python_version(),
            packages=packages() | imported,
            platform=platform.platform(),
            processor=processor(),
            backend=backend,
            workers=executor.count,
            executor=executor.name,
        ),
        started=started.isoformat(timespec="seconds"),
        finished=finished.isoformat(timespec="seconds"),
        wall_s=round((finished - started).total_seconds(), 3),
        blocks_computed=result.blocks_computed,
        blocks_kept=result.blocks_kept,
        library_hash=result.library_hash,
        rechecks=result.rechecks,
    )
    return amend(folder, provenance, names)


def amend(folder: Path, provenance: RunProvenance, names: Iterable[str]) -> RunProvenance:
    """Write the provenance of a run with the digests of more files as they are in its folder."""
    files = {**provenance.files, **seal(folder, names)}
    sealed = provenance.model_copy(update={"files": files})
    write_text(folder / PROVENANCE, sealed.model_dump_json(indent=2) + "\n", folder)
    return sealed


def seal(folder: Path, names: Iterable[str]) -> dict[str, str]:
    """Return the SHA-256 of each file by name."""
    return {name: sha256(contents(folder / name)).hexdigest() for name in names}


def unseal(folder: Path, digests: Mapping[str, str], needed: Iterable[str]) -> dict[str, bytes]:
    """Return the contents of every file that `digests` names, by name.

    Raises `UserError`, with the names, where one that is needed has no digest, one is missing, or
    one has another digest: it was changed.
    """
    unnamed = [name for name in needed if name not in digests]
    if unnamed:
        raise UserError(
            f"{folder / PROVENANCE} has no digest of {', '.join(unnamed)}, as if an earlier "
            f"faultpath had written it: {AGAIN}."
        )
    files = {name: read_regular(folder / name) for name in digests}
    changed = [name for name, data in files.items() if sha256(data).hexdigest() != digests[name]]
    if changed:
        raise UserError(
            f"{folder}: {', '.join(changed)} changed since the run, by the SHA-256 in "
            f"{PROVENANCE}: bring back what the run wrote, or {AGAIN}."
        )
    return files


def checkout(main: Path, files: Iterable[Path]) -> tuple[str | None, bool | None]:
    """Return the commit of the checkout that tracks `main`, and whether `files` differ from it.

    `(None, None)` without one. A file installed into an environment that happens to lie inside
    some other repository is not tracked there, and that repository's commit would say nothing.
    """
    if _git(main.parent, "ls-files", "--error-unmatch", "--", main.name) is None:
        return None, None
    top = Path(_git(main.parent, "rev-parse", "--show-toplevel") or main.parent)
    inside = [str(path) for path in files if path.resolve().is_relative_to(top)]
    changes = _git(top, "status", "--porcelain", "--untracked-files=all", "--", *inside)
    return _git(top, "rev-parse", "HEAD"), None if changes is None else bool(changes)


def _git(folder: Path, *arguments: str) -> str | None:
    command = ["git", "-C", str(folder), *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()


def processor() -> str:
    """Return the model of the processor, as well as the platform tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    models = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(models, "") or platform.processor() or platform.machine()
