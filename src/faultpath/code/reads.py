"""Files that a process reads and that nobody named."""

import os
import sys
from pathlib import Path

from faultpath.code.places import Kind, kind_of
from faultpath.code.state import Code

_CODE = frozenset({".py", ".pyc", ".pyd", ".so"})
_OF_THE_MACHINE = ("/dev/", "/etc/", "/proc/", "/sys/", "/usr/")
_OURS = os.path.realpath(Path(__file__).parents[1]) + os.sep


class Reads:
    """Notes every file that this process opens to read, from `start` on until it ends.

    Files that a library in another language opens by itself are not seen.
    """

    def __init__(self) -> None:
        self._opened: set[str] = set()

    def start(self) -> None:
        """Begin. An audit hook cannot be taken away again: this is for processes of our own."""
        sys.addaudithook(self._note)

    def opened(self) -> frozenset[str]:
        """Return what was opened so far."""
        return frozenset(self._opened)

    def forget(self, but: frozenset[str] = frozenset()) -> None:
        """Leave out what was opened so far, but for some of it."""
        self._opened = set(but)

    def undeclared(self, code: Code) -> tuple[str, ...]:
        """Return and forget the user's files that were read and are not among those of `code`."""
        known = {os.path.realpath(path) for path in (*code.sources.values(), *code.data.values())}
        opened, self._opened = self._opened, set()
        found = {os.path.realpath(path) for path in opened}
        return tuple(sorted(path for path in found - known if _is_users(Path(path))))

    def _note(self, event: str, arguments: tuple[object, ...]) -> None:
        if event != "open":
            return
        path, _, flags = arguments
        if isinstance(path, str) and isinstance(flags, int) and not flags & os.O_ACCMODE:
            self._opened.add(path)


def _is_users(path: Path) -> bool:
    text = str(path)
    return (
        path.suffix not in _CODE
        and not text.startswith((*_OF_THE_MACHINE, _OURS))
        and not any(part.startswith(".") for part in path.parts)
        and path.is_file()
        and kind_of(path) is Kind.LOCAL
    )
