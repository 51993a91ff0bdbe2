"""The files of a finished run, and whether they are still as the run left them.

A run folder may come from anybody and may have been edited by anybody. Its provenance names each
file that a report is made from with a digest; whoever reads the folder reads all of them, compares,
and parses the very bytes that it has compared.
"""

import hashlib
from collections.abc import Iterable, Mapping
from pathlib import Path

from faultpath.core.errors import UserError
from faultpath.core.files.opening import contents

AGAIN = "run it again, into a new folder"


def seal(folder: Path, names: Iterable[str]) -> dict[str, str]:
    """Return the SHA-256 of each file by name."""
    return {name: _digest(contents(folder / name)) for name in names}


def unseal(folder: Path, digests: Mapping[str, str], needed: Iterable[str]) -> dict[str, bytes]:
    """Return the contents of every file that `digests` names, by name.

    Raises `UserError`, with the names, where one that is needed has no digest, one is missing, or
    one has another digest: it was changed.
    """
    unnamed = [name for name in needed if name not in digests]
    if unnamed:
        raise UserError(
            f"{folder / 'provenance.json'} has no digest of {', '.join(unnamed)}, as if an earlier "
            f"faultpath had written it: {AGAIN}."
        )
    contents = {name: read_regular(folder / name) for name in digests}
    changed = [name for name, data in contents.items() if _digest(data) != digests[name]]
    if changed:
        raise UserError(
            f"{folder}: {', '.join(changed)} changed since the run, by the SHA-256 in "
            f"provenance.json: bring back what the run wrote, or {AGAIN}."
        )
    return contents


def read_regular(path: Path) -> bytes:
    """Return the contents of a file; `UserError` where there is none to read."""
    try:
        return contents(path)
    except FileNotFoundError:
        raise UserError(
            f"{path.parent} holds no {path.name}: give the folder of a finished run."
        ) from None
    except OSError as error:
        raise UserError(
            f"{path} cannot be read ({error.strerror}): give the folder of a finished run."
        ) from error


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
