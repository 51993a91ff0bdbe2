"""Text made safe for a terminal, parts of sentences, names that do not exist, numbers in text."""

import math
import os
import re
import sys
import unicodedata
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import Any

from faultpath.core.errors import Notice

ADDRESS = " at 0x[0-9a-f]+"
"""Pattern of where an object lies, as its `repr` says; another one in each process."""
LARGEST_NUMBER = 1e300
"""Size up to which sums and differences of a million numbers stay finite."""
_DIGITS = 19
_WORD = re.compile(r"\S{240,}")
_LONGEST = 4000
_MOST, _FEW = 20, 8
"""Names that a sentence lists at most, and how many it lists where there are more."""
_NUMPY = re.compile(
    r"(divide by zero|overflow|underflow|invalid value) encountered"
    r"|Mean of empty slice|All-NaN|Degrees of freedom <= 0"
)


def has_control_characters(text: str) -> bool:
    """Return whether text holds control characters, line separators or lone surrogates."""
    hidden = ("Cc", "Cs", "Zl", "Zp")
    return not text.isprintable() and any(unicodedata.category(c) in hidden for c in text)


def printable(text: str) -> str:
    """Escape control characters, lone surrogates and marks of direction.

    Line breaks are escaped as well, so that a name stays on its line.
    """
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text
    )


def one_line(text: str) -> str:
    """Return a message as one readable line.

    Line breaks become spaces, other invisible characters are escaped, and very long words and
    messages are cut in the middle.
    """
    line = printable(" ".join(part.strip() for part in text.split("\n") if part.strip()))
    line = _WORD.sub(lambda word: _cut(word[0], 120), line)
    return line if len(line) <= _LONGEST else _cut(line, _LONGEST // 2)


def represented(value: object) -> str:
    """Return `repr(value)`, or its type where a user's object fails at that."""
    try:
        return repr(value)
    except Exception:
        return f"a {type(value).__name__}"


def shortened(text: str, most: int) -> str:
    """Return a text of at most `most` characters."""
    return text if len(text) <= most else f"{text[: most - 1]}…"


def listed(names: Iterable[str]) -> str:
    """Return names in one line, `none` when there are none."""
    return ", ".join(sorted(names)) or "none"


def counted(count: int, noun: str) -> str:
    """Return `1 pair` or `2 pairs`."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def series(items: Sequence[str]) -> str:
    """Return `a`, `a and b` or `a, b and c`."""
    return " and ".join(filter(None, (", ".join(items[:-1]), items[-1])))


def capital(words: str) -> str:
    """Return words with a capital letter in front, whatever follows."""
    return words[:1].upper() + words[1:]


def unknown(what: str, name: str, known: Iterable[str]) -> str:
    """Return `unknown WHAT 'NAME'`, a close match where there is one, and the known names.

    Of many names only those closest to `name` are listed.
    """
    known = tuple(known)
    close = get_close_matches(name, known, n=1)
    hint = f"did you mean '{close[0]}'? " if close else ""
    shown = known if len(known) <= _MOST else get_close_matches(name, known, _FEW, cutoff=0.0)
    more = f" and {len(known) - len(shown)} more" if len(shown) < len(known) else ""
    return f"unknown {what} '{name}'; {hint}known: {listed(shown)}{more}"


def number_in(text: str) -> float:
    """Return the number in a text; `ValueError` says what is needed instead."""
    text = text.strip()
    try:  # Python reads 1_0 as ten, and digits of every script
        number = float(text if text.isascii() and "_" not in text else "no number")
    except ValueError:
        raise ValueError("a number") from None
    if not math.isfinite(number):
        raise ValueError("a finite number")
    if number == 0.0 and re.match(r"[-+.0]*[1-9]", text):
        raise ValueError("0, or a number that does not round to it")
    return number


def number_of(value: object) -> float:
    """Return a number, or the number in a text, that is small enough for sums.

    Raises as `number_in`.
    """
    if not isinstance(value, str | int | float):
        raise ValueError("a number")
    number = number_in(value) if isinstance(value, str) else value
    if not abs(number) <= LARGEST_NUMBER:
        raise ValueError(f"a number from {-LARGEST_NUMBER:g} to {LARGEST_NUMBER:g}")
    return float(number)


def whole_in(text: str) -> int:
    """Return the whole number in a text; `ValueError` says what is needed instead."""
    if not re.fullmatch(r"[-+]?[0-9]+", text):
        raise ValueError("a whole number")
    if len(text.lstrip("+-")) > _DIGITS:
        raise ValueError(f"a number of at most {_DIGITS} digits")
    return int(text)


def near(file: str) -> str:
    """Return a path relative to the working folder where it lies below, else in full."""
    try:
        path = os.path.relpath(file)
    except FileNotFoundError:  # the working folder was removed
        return file
    return file if path.startswith(os.pardir) else path


def extra(name: str) -> str:
    """Return how to install an extra of faultpath, which needs its checkout."""
    return f"in the checkout of faultpath, pip install '.[{name}]'"


def show_warning(
    message: Warning | str, category: type[Warning], filename: str, lineno: int, *more: Any
) -> None:
    """Show a warning in one line, a notice as a sentence; replaces `warnings.showwarning`.

    NumPy's warnings of overflow and NaN are left out, because the results say where it matters.
    """
    del more
    if isinstance(message, Notice):
        sys.stderr.write(f"faultpath: {message}\n")
        return
    if issubclass(category, RuntimeWarning) and _NUMPY.match(str(message)):
        return
    line = one_line(f"{near(filename)}, line {lineno}: {category.__name__}: {message}")
    sys.stderr.write(f"{line}\n")


def _cut(text: str, kept: int) -> str:
    left_out = len(text) - 2 * kept
    return text if left_out <= 0 else f"{text[:kept]}…({left_out} more)…{text[-kept:]}"
