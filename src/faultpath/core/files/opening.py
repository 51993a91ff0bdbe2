"""Opens files that another person may have made; no other module opens those.

Reading a pipe, a device or a socket might never begin or never end. The check is of the open file,
so that nothing can replace it between the check and the read.
"""

import errno
import os
import stat
from io import BufferedReader
from pathlib import Path

from faultpath.core.errors import UserError

LARGEST = 4 * 2**30
"""Bytes of a file: a hundred times a table of a million trials; more may fill the memory."""
LARGEST_TEXT = 256 * 2**20
"""Bytes of JSON, which takes several times as much in memory."""


def most_unpacked(packed: int) -> int:
    """Return how many bytes a packed file may unpack to: a small file must not fill the memory."""
    return min(LARGEST, max(LARGEST_TEXT, 100 * packed))


_SPECIAL_FILES = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


def named_path(text: str | Path) -> Path:
    """Return the path of a file or folder that a user names; `ValueError` for what can be none.

    An empty path would mean the working directory, which nobody has asked to be written into.
    """
    if not str(text):
        raise ValueError("an empty path names nothing, give one that is not empty")
    if "\0" in str(text):
        raise ValueError("a path cannot have a null character in it")
    try:
        Path(text).resolve()
    except RuntimeError:  # what `resolve` raises for a link that leads back to itself
        raise ValueError(f"the link {str(text)!r} leads back to itself") from None
    return Path(text)


def special_kind(mode: int) -> str:
    """Return what a file mode stands for, such as `a pipe`; empty for a file."""
    return next((kind for is_kind, kind in _SPECIAL_FILES if is_kind(mode)), "")


def opened(path: str | os.PathLike[str], most: int = LARGEST) -> BufferedReader:
    """Open a file to read, without ever waiting.

    Raises `OSError`, whose `strerror` says why, for anything but a file and for a file of more than
    `most` bytes.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except ValueError as error:  # a null character, or no text at all
        raise OSError(errno.EINVAL, "nothing can have that name") from error
    except OSError as error:
        if error.errno == errno.ENXIO:
            raise OSError(errno.ENXIO, "it is a socket, not a file", path) from error
        raise
    try:
        status = os.fstat(descriptor)
        if kind := special_kind(status.st_mode):
            raise OSError(errno.EINVAL, f"it is {kind}, not a file", path)
        if status.st_size > most:
            raise _too_large(path, most)
        return os.fdopen(descriptor, "rb")
    except BaseException:
        os.close(descriptor)
        raise


def contents(path: str | os.PathLike[str], most: int = LARGEST) -> bytes:
    """Return the contents of a file; raises as `opened`."""
    with opened(path, most) as file:
        data = file.read(most + 1)
    if len(data) > most:  # it grew, or is one of the kernel's, which state no size
        raise _too_large(path, most)
    return data


def _too_large(path: str | os.PathLike[str], most: int) -> OSError:
    size = f"{most / 2**30:g} GiB" if most >= 2**30 else f"{most / 2**20:.3g} MiB"
    return OSError(errno.EFBIG, f"it is larger than {size}", path)


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
