"""Warnings of a user's system, each in a line that is fit for a terminal."""

import os
import re
import sys
from typing import Any

from faultpath.core.text import one_line

_NUMPY = re.compile(
    r"(divide by zero|overflow|underflow|invalid value) encountered"
    r"|Mean of empty slice|All-NaN|Degrees of freedom <= 0"
)


def show_warning(
    message: Warning | str, category: type[Warning], filename: str, lineno: int, *more: Any
) -> None:
    """Show a warning in one line, in place of `warnings.showwarning`.

    What NumPy says of numbers that overflow or are none is left out: what becomes of them is said
    where it matters.
    """
    del more
    if issubclass(category, RuntimeWarning) and _NUMPY.match(str(message)):
        return
    near = os.path.relpath(filename)
    place = filename if near.startswith(os.pardir) else near
    said = one_line(f"{place}, line {lineno}: {category.__name__}: {message}")
    sys.stderr.write(f"{said}\n")
