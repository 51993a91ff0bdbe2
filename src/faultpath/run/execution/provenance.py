"""Where a run's numbers come from: code, packages, machine and command."""

import platform
import subprocess
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from pathlib import Path

from faultpath.core import __version__
from faultpath.core.files.atomic import write_text
from faultpath.core.files.opening import LARGEST_TEXT, contents
from faultpath.core.files.plain import model_of
from faultpath.core.trees import packages, release
from faultpath.run.execution.runner import RunResult
from faultpath.run.provenance import RunCode, RunMachine, RunProvenance
from faultpath.run.store.folder import seal
from faultpath.run.work.executor import Executor

PROVENANCE = "provenance.json"


def run_provenance(
    folder: Path,
    names: Iterable[str],
    result: RunResult,
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
    package = Path(__file__).parents[2] / "__init__.py"
    commit, dirty = checkout(package, [package.parent])
    system_commit, system_dirty = None, None
    if result.code and (main := result.code[0].main):
        ran = (*result.code[0].sources, *result.code[0].data.values())
        system_commit, system_dirty = checkout(main, ran)
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


def processor() -> str:
    """Return the model of the processor, as well as the platform tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    models = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(models, "") or platform.processor() or platform.machine()


def _git(folder: Path, *arguments: str) -> str | None:
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *arguments],
            capture_output=True,
            text=True,
            timeout=10,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()
