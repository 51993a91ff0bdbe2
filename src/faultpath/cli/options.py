"""What several verbs take, and how they end."""

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Annotated

import typer

from faultpath.errors import UserError
from faultpath.text import one_line, steers

_LONGEST = 4096
"""What Linux takes for a path; nothing else that is asked for needs as much."""
LARGEST = 2**63 - 1
"""What the tables hold."""
FAILED_TRIALS = 1
"""Exit status of a verb that finished although trials failed."""


TimeLimit = Annotated[
    float | None,
    typer.Option(
        help="Seconds that a block of scenes may take; default what the system says, else 3600."
    ),
]
"""`--time-limit` of the verbs that fly."""


Executor = Annotated[
    str,
    typer.Option(
        help="local, or ray for a Ray cluster: the one that RAY_ADDRESS names or that runs here, "
        "else one of its own; ray:HOST:PORT names it."
    ),
]
"""`--executor` of the verbs that fly."""


SET = "System option, key=value; for scripts, and where a flag above has the same name."
"""Help of `--set`."""


def check_arguments(arguments: Sequence[str]) -> None:
    """Refuse arguments that can name nothing; they would fail later, and garble the terminal."""
    for before, argument in pairwise(("", *arguments)):
        flag = f"{before} " if before.startswith("--") and "=" not in before else ""
        # A word without a flag is named by what reads it.
        if (flag and not argument) or re.fullmatch(r"--[\w-]+=", argument):
            said = argument or f"{flag}''"
            raise UserError(f"the argument {said} is empty: give a value, or leave it out.")
        if foreign := next(filter(_foreign_number, re.split(r"[,=:/@]|\.\.", argument)), ""):
            raise UserError(
                f"the argument {flag}'{one_line(argument)}' holds the number {foreign}: write it "
                "in the digits 0 to 9."
            )
        if steers(argument):
            raise UserError(
                f"the argument '{one_line(argument)}' holds control characters or is not UTF-8 "
                "text: write it without them."
            )
        if len(argument.encode()) > _LONGEST:
            raise UserError(
                f"the argument '{one_line(argument)}' is too long: write at most {_LONGEST} bytes."
            )


def _foreign_number(text: str) -> bool:
    if text.isascii():
        return False
    try:
        float(text)
    except ValueError:
        return False
    return True


def settings(pairs: Sequence[str], named: Mapping[str, str] | None = None) -> dict[str, str]:
    """Read `key=value` pairs, beside options that have a name of their own.

    `UserError` for a pair without `=`, and for what is given twice.
    """
    found = dict(named or {})
    for pair in pairs:
        key, separator, value = pair.partition("=")
        if not separator or not key:
            raise UserError(f"--set {pair!r} is not of the form key=value, for example wind=L3.")
        if key in found:
            raise UserError(f"the options name '{key}' twice: give it once.")
        found[key] = value
    return found


def names(text: str, what: str) -> tuple[str, ...]:
    """Read comma-separated names; `UserError` for an empty one, and for one given twice."""
    found = tuple(part.strip() for part in text.split(","))
    if not all(found):
        raise UserError(f"{what} '{text}' holds an empty name: part names by one comma each.")
    if twice := [name for place, name in enumerate(found) if name in found[:place]]:
        raise UserError(f"{what} '{text}' names '{twice[0]}' twice: name each once.")
    return found


def numbers(text: str, what: str) -> tuple[int, ...]:
    """Read comma-separated seeds such as `0,1,2`; `UserError` for what is none."""
    return tuple(_seed(part, f"{what} {text!r}") for part in text.split(","))


def _seed(text: str, said: str) -> int:
    if not re.fullmatch(r"-?[0-9]+", text.strip()):
        raise UserError(f"{said} is not a list of whole numbers, for example 0,1,2.")
    if len(text.strip()) > 19 or not 0 <= int(text) <= LARGEST:
        raise UserError(f"{said}: a seed lies between 0 and 2^63 - 1.")
    return int(text)


def sizes(text: str, what: str) -> tuple[float, ...]:
    """Read comma-separated numbers such as `0.1,0.2`; `UserError` for what is none."""
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise UserError(f"{what} {text!r} is not a list of numbers, for example 0.1,0.2.") from None


def refuse_unless(needed: str, **given: object) -> None:
    """Raise `UserError` for options that were given and only go with another one."""
    if idle := _named(given):
        raise UserError(f"{idle} would do nothing here: give it with {needed}, or leave it out.")


def refuse_with(other: str, **given: object) -> None:
    """Raise `UserError` for options that were given and do nothing beside another one."""
    if idle := _named(given):
        raise UserError(f"{idle} would do nothing with {other}: leave it out.")


def _named(given: Mapping[str, object]) -> str:
    asked = (name.replace("_", "-") for name, value in given.items() if value is not None)
    return " and ".join(f"--{name}" for name in asked)


def path(text: str | Path) -> Path:
    """Read the path of a file or folder.

    Given as `parser=` to every option and argument that is one: an empty path would mean the
    working directory, which nobody has asked to be written into.
    """
    if not str(text):
        raise typer.BadParameter("an empty path names nothing, give one that is not empty")
    if "\0" in str(text):
        raise typer.BadParameter("a path cannot have a null character in it")
    try:
        Path(text).resolve()
    except RuntimeError:  # what `resolve` raises for a link that leads back to itself
        raise typer.BadParameter(f"the link {str(text)!r} leads back to itself") from None
    return Path(text)


Share = Annotated[
    Path | None,
    typer.Option(
        parser=path,
        help="Folder in which runs share trials, with --out; without it runs/.shared.",
    ),
]
"""`--share` of the verbs whose runs do."""
