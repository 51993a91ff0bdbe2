"""Noticing that a file changes before it is read."""

from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

_Stamp = tuple[int, int, int]


@dataclass(frozen=True)
class Watched:
    """A file and the digest that it had."""

    path: Path
    sha256: str


class Watch:
    """Files that a process may still read, such as weights and modules imported late.

    A glance costs one `stat` a file; contents are compared only where that shows another time,
    size or file.
    """

    def __init__(self, files: Mapping[str, Watched]) -> None:
        self._files = files
        self._stamps = {name: _stamp(file.path) for name, file in files.items()}

    def changed(self) -> tuple[str, ...]:
        """Return the names of the files whose contents are not what they were."""
        return tuple(name for name in self._files if self._differs(name))

    def _differs(self, name: str) -> bool:
        file, stamp = self._files[name], _stamp(self._files[name].path)
        if stamp == self._stamps[name] and stamp is not None:
            return False
        try:
            same = sha256(file.path.read_bytes()).hexdigest() == file.sha256
        except OSError:
            return True
        if same:
            self._stamps[name] = stamp
        return not same


def _stamp(path: Path) -> _Stamp | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino
