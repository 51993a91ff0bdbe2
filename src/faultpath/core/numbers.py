"""Numbers in text: in ASCII digits, finite, and not rounded to zero."""

import math
import re

LARGEST = 1e300
"""Size up to which sums and differences of a million numbers stay finite."""
_DIGITS = 19


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
    if not abs(number) <= LARGEST:
        raise ValueError(f"a number from {-LARGEST:g} to {LARGEST:g}")
    return float(number)


def whole_in(text: str) -> int:
    """Return the whole number in a text; `ValueError` says what is needed instead."""
    if not re.fullmatch(r"[-+]?[0-9]+", text):
        raise ValueError("a whole number")
    if len(text.lstrip("+-")) > _DIGITS:
        raise ValueError(f"a number of at most {_DIGITS} digits")
    return int(text)
