"""Files that are whole or absent even if the process is killed, and a lock for a run folder.

A file replaces another file and nothing else: a device, a pipe, a socket or a folder of that name
is left as it is. Symbolic links are followed, as by any program that opens a file, so that the link
stays and its target is replaced.
"""

import errno
import fcntl
import os
import stat
import tempfile
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from pathlib import Path

from faultpath.core.errors import UserError
from faultpath.core.files.opening import LARGEST_TEXT, contents, opened, special_kind

_PREFIX = ".partial-"
Say = Callable[[str], None]


def write(path: Path, data: bytes, inside: Path | None = None) -> None:
    """Write a file so that a reader, or a machine that loses power, sees all of it or none.

    `inside` is the folder that the file belongs to, where faultpath itself names it: a link there
    that leads out of the folder is refused, since the folder may be another person's.

    Raises `OSError` where the file cannot be written, or where `path` is there and no file.
    """
    target = _target(path, inside)
    descriptor, name = tempfile.mkstemp(prefix=_PREFIX, dir=target.parent)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.umask(mask := os.umask(0o022))
        os.chmod(name, 0o666 & ~mask)  # mkstemp hides the file from other users
        os.replace(name, target)
    except BaseException:
        with suppress(OSError):
            os.unlink(name)
        raise
    folder = os.open(target.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def write_file(path: Path, data: bytes, inside: Path | None = None) -> None:
    """Write a file as `write` does; `UserError` when it cannot be written."""
    try:
        write(path, data, inside)
    except OSError as error:
        raise _unwritable(path, error) from error


def write_text(path: Path, text: str, inside: Path | None = None) -> None:
    """Write a text file as `write_file` does."""
    write_file(path, text.encode(), inside)


def is_run(folder: Path) -> bool:
    """Return whether a folder holds a run, finished or begun."""
    for name in ("provenance.json", "manifest.json"):
        with suppress(OSError):
            if b'"faultpath_version"' in contents(folder / name, LARGEST_TEXT):
                return True
    with suppress(OSError):
        return contents(folder / ".lock").strip().isdigit()
    return False


def check_free(folder: Path) -> None:
    """Raise `UserError` for a folder in which a run would begin among other files."""
    if names := sorted(file.name for file in folder.glob("*") if not file.name.startswith(".")):
        raise holds_others(folder, names[0])


def holds_others(folder: Path, name: str) -> UserError:
    """Return the error of a folder that holds a file of no run."""
    return UserError(f"{folder} holds {name}, which is not of this run: give a new folder.")


def check_folder(path: Path) -> None:
    """Raise `UserError` where something else than a folder stands, at its place or above."""
    for part in (path, *path.parents):
        with suppress(OSError):
            mode = part.stat().st_mode
            if not stat.S_ISDIR(mode):
                raise UserError(f"{part} is {special_kind(mode) or 'a file'}: name a folder.")
            return


def check_output(path: Path, mark: bytes | None = None) -> None:
    """Raise `UserError` where a file that the user names cannot be written, lies in the folder of a
    run, or exists without the `mark` of the file that is to replace it."""
    check_writable(path)
    if is_run(Path(os.path.realpath(path)).parent):
        raise UserError(f"{path} lies in the folder of a run: give a file outside.")
    if path.exists():
        check_mark(path, mark)


def check_mark(path: Path, mark: bytes | None) -> None:
    """Raise `UserError` for a file whose beginning does not hold `mark`."""
    with opened(path) as file:
        head = file.read(4096)
    if head and (mark is None or mark not in head):
        raise UserError(
            f"{path} is there already, and not a file that this may replace: remove it, or "
            "choose another file."
        )


def check_writable(path: Path) -> None:
    """Raise `UserError` where no file can be written, before the work that would fill it."""
    try:
        target = _target(path, None)
        if not target.parent.is_dir():
            raise OSError(errno.ENOENT, "there is no such folder")
        if not os.access(target.parent, os.W_OK | os.X_OK):
            raise OSError(errno.EACCES, "permission denied")
    except OSError as error:
        raise _unwritable(path, error) from error


def make_folder(path: Path) -> None:
    """Make a folder and its parents unless they exist; `UserError` where that fails."""
    check_folder(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(
            f"cannot make the folder {path} ({error.strerror}): choose another path"
        ) from error


def sweep(folder: Path) -> None:
    """Remove the partial files of killed writers. The caller holds the folder's lock."""
    try:
        for leftover in folder.glob(_PREFIX + "*"):
            leftover.unlink(missing_ok=True)
    except OSError as error:
        raise _unwritable(folder, error) from error


def _unwritable(path: Path, error: OSError) -> UserError:
    return UserError(
        f"cannot write {path} ({error.strerror}): choose a folder that you may write "
        "to and that has room"
    )


def _target(path: Path, inside: Path | None) -> Path:
    try:
        mode = os.stat(path).st_mode
    except FileNotFoundError:  # or a link to a file that does not exist yet
        mode = stat.S_IFREG
    except ValueError as error:
        raise OSError(errno.EINVAL, "the path has a null character in it") from error
    if kind := special_kind(mode):
        raise OSError(errno.EEXIST, f"it is {kind}, not a file")
    target = Path(os.path.realpath(path))
    if inside is not None and path.is_symlink() and not target.is_relative_to(inside.resolve()):
        raise OSError(errno.ELOOP, f"it is a link out of {inside}")
    return target


@contextmanager
def locked(folder: Path, notice: Say) -> Generator[None, None, None]:
    """Hold the lock of `folder`, after waiting for any other process that holds it.

    The kernel releases the lock when this process ends, however it ends. Its file descriptor is not
    inherited, so a worker that outlives this process cannot keep it.
    """
    path = folder / ".lock"
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
    except OSError as error:
        raise UserError(
            f"cannot write to {folder} ({error.strerror}): choose a folder that you may write to"
        ) from error
    try:
        if kind := special_kind(os.fstat(descriptor).st_mode):
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
