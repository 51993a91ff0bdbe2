"""One process at a time in a run folder."""

import fcntl
import os
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path

from faultpath.core.errors import UserError
from faultpath.core.files.opening import unlike_file

Say = Callable[[str], None]


@contextmanager
def locked(folder: Path, notice: Say) -> Generator[None, None, None]:
    """Hold the lock of `folder`, waiting for another process that does.

    The kernel holds the lock for this process and lets it go when the process dies, however it
    dies. Its file descriptor is not inherited, so a worker that outlives us cannot keep it.
    """
    path = folder / ".lock"
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
    except OSError as error:
        raise UserError(
            f"cannot write to {folder} ({error.strerror}): choose a folder that you may write to"
        ) from error
    try:
        if kind := unlike_file(os.fstat(descriptor).st_mode):
            raise UserError(f"{path} is {kind}, not a file: remove it, or choose another folder")
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.pread(descriptor, 32, 0).decode(errors="replace").strip() or "unknown"
            notice(f"another faultpath process (id {holder}) works in {folder}; waiting for it")
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        except OSError as error:
            raise UserError(
                f"cannot lock {folder} ({error.strerror}): choose a folder on a local disk"
            ) from error
        os.truncate(descriptor, 0)
        os.pwrite(descriptor, f"{os.getpid()}\n".encode(), 0)
        yield
    finally:
        os.close(descriptor)
