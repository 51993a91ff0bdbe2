"""Reading what several verbs take."""

from collections.abc import Sequence
from pathlib import Path

import typer

from faultpath.errors import UserError


class Stopped(UserError):
    """Ctrl-C ended the command; the sentence says what is kept and how to go on."""


def settings(pairs: Sequence[str]) -> dict[str, str]:
    """Read `key=value` pairs; `UserError` for one without `=` or given twice."""
    found: dict[str, str] = {}
    for pair in pairs:
        key, separator, value = pair.partition("=")
        if not separator or not key:
            raise UserError(f"--set {pair!r} is not of the form key=value, for example wind=L3.")
        if key in found:
            raise UserError(f"--set gives '{key}' twice: give it once.")
        found[key] = value
    return found


def numbers(text: str, what: str) -> tuple[int, ...]:
    """Read comma-separated integers such as `0,1,2`."""
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise UserError(
            f"{what} {text!r} is not a list of whole numbers, for example 0,1,2."
        ) from None


def path(text: str | Path) -> Path:
    """Read the path of a file or folder.

    Given as `parser=` to every option and argument that is one: an empty path would mean the
    working directory, which nobody has asked to be written into.
    """
    if not str(text):
        raise typer.BadParameter("an empty path names nothing, give one that is not empty")
    if "\0" in str(text):
        raise typer.BadParameter("a path cannot have a null character in it")
    return Path(text)
