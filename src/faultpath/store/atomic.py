"""Files that are either whole or absent, whenever the process is killed."""

import os
import tempfile
from contextlib import suppress
from pathlib import Path

from faultpath.errors import UserError

_PREFIX = ".partial-"


def write(path: Path, data: bytes) -> None:
    """Write a file so that a reader, or a machine that loses power, sees all of it or none."""
    descriptor, name = tempfile.mkstemp(prefix=_PREFIX, dir=path.parent)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(name, 0o666 & ~_umask())  # mkstemp hides the file from other users
        os.replace(name, path)
    except BaseException:
        with suppress(OSError):
            os.unlink(name)
        raise
    _sync_folder(path.parent)


def write_text(path: Path, text: str) -> None:
    """Write a text file as `write` does; `UserError` when it cannot be written."""
    try:
        write(path, text.encode())
    except OSError as error:
        raise UserError(
            f"cannot write {path} ({error.strerror}): choose a place that you may write to"
        ) from error


def sweep(folder: Path) -> None:
    """Remove what killed writers left in a folder. Call it with the folder locked."""
    for leftover in folder.glob(_PREFIX + "*"):
        leftover.unlink(missing_ok=True)


def _umask() -> int:
    mask = os.umask(0o022)
    os.umask(mask)
    return mask


def _sync_folder(folder: Path) -> None:
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
