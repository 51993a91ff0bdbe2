"""By which code a stored run was flown, and whether that is the code that is here."""

from collections.abc import Mapping
from contextlib import chdir
from functools import cache
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

from faultpath.core.errors import UserError
from faultpath.trials import SystemSpec, load_system
from faultpath.trials.code import CodeState, source_state, system_code
from faultpath.trials.provenance import RunProvenance

ROOT = Path(__file__).resolve().parents[1]


def flown_by(origin: RunProvenance, system: str, options: Mapping[str, str]) -> str:
    """Return in a sentence by which commit a run was flown, and whether what flies has changed.

    What flies: the sources and the data files, trained weights among them, whose digests the run
    kept. Only that they changed is said, not how many, so that a document goes stale once.
    """
    commit = f"commit `{origin.commit[:12]}`" if origin.commit else "code of no known commit"
    done = "Finished" if origin.blocks_kept else "Run"  # parts may have been run before
    text = f"{done} at {commit}{' with uncommitted changes' if origin.dirty else ''}"
    if not origin.sources:
        return f"{text}, before runs kept digests of their code: by older code than today's."
    if not changed(origin, system, options):
        return f"{text}; its code has not changed since."
    return f"{text}; its code{' or weights' if origin.data else ''} changed since."


def changed(origin: RunProvenance, system: str, options: Mapping[str, str]) -> bool:
    """Return whether sources or data files are other ones than a run kept, or it kept none."""
    if not origin.sources:
        return True
    here = _state(system, tuple(sorted(options.items())), tuple(origin.data))
    flown = {name: sha for name, sha in origin.sources.items() if name in here.files or _here(name)}
    return (here.files, here.data) != (flown, origin.data)


@cache
def _state(
    system: str, options: tuple[tuple[str, str], ...], data: tuple[str, ...] = ()
) -> CodeState:
    """Return the state of code and data here; `data` names the files that a run kept."""
    spec = SystemSpec(name=system, options=dict(options))
    with chdir(ROOT):
        try:
            return system_code(load_system(spec), spec).state
        except UserError as error:
            if not isinstance(error.__cause__, ModuleNotFoundError):
                raise
            # It runs on a package that documents do without.
            places = {name: Path(system).parent / name for name in data}
            digests = {
                n: sha256(p.read_bytes()).hexdigest() for n, p in places.items() if p.is_file()
            }
            return source_state(spec).model_copy(update={"data": digests})


def _here(source: str) -> bool:
    """Return whether a source file is one of the project's, or of a package that is installed."""
    package, _, rest = source.partition("/")
    return not rest or find_spec(package) is not None
