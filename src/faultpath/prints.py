"""What a user's system prints or warns of, as lines that are fit for a terminal."""

import io
import os
import re
import sys
from collections.abc import Generator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from typing import Any, TextIO

from faultpath.text import one_line

_NUMPY = re.compile(
    r"(divide by zero|overflow|underflow|invalid value) encountered"
    r"|Mean of empty slice|All-NaN|Degrees of freedom <= 0"
)


class Lines(io.TextIOWrapper):
    """A stream that writes whole lines to the one behind it, escaped and with a head."""

    def __init__(self, behind: TextIO, head: str = "") -> None:
        self.behind = behind
        self._lines = _Lines(behind, head)
        more: dict[str, Any] = {"encoding": "utf-8", "errors": "backslashreplace"}
        super().__init__(self._lines, write_through=True, newline="", **more)  # pyright: ignore[reportArgumentType]

    def finish(self) -> None:
        """Write what has no line break yet."""
        self._lines.write(b"\n")


class _Lines(io.RawIOBase):
    def __init__(self, behind: TextIO, head: str) -> None:
        self._behind, self._head, self._rest = behind, head, b""

    def writable(self) -> bool:
        return True

    def fileno(self) -> int:
        return self._behind.fileno()

    def write(self, data: Any, /) -> int:
        *lines, self._rest = re.split(rb"[\r\n]", self._rest + bytes(data))
        for line in lines:
            if said := one_line(line.decode(errors="backslashreplace")):
                self._behind.write(f"{self._head}{said}\n")
        return len(data)


@contextmanager
def prints_of(head: str) -> Generator[None]:
    """Write what Python code prints meanwhile to standard error, in lines of their own."""
    lines = Lines(sys.stderr, f"{one_line(head)}: ")
    try:
        with redirect_stdout(lines), redirect_stderr(lines):
            yield
    finally:
        lines.finish()


def show_warning(
    message: Warning | str, category: type[Warning], filename: str, lineno: int, *more: Any
) -> None:
    """Show a warning in one line, in place of `warnings.showwarning`.

    What NumPy says of numbers that overflow or are none is left out: what becomes of them is told
    where it matters.
    """
    del more
    if issubclass(category, RuntimeWarning) and _NUMPY.match(str(message)):
        return
    near = os.path.relpath(filename)
    place = filename if near.startswith(os.pardir) else near
    said = one_line(f"{place}, line {lineno}: {category.__name__}: {message}")
    getattr(sys.stderr, "behind", sys.stderr).write(f"{said}\n")
