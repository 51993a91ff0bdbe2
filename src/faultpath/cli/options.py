"""What several verbs take, and how they end."""

import re
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Annotated, TypeVar

import typer

from faultpath.core.errors import UserError
from faultpath.core.text import one_line, steers

_LONGEST = 4096
"""What Linux takes for a path; nothing else that is asked for needs as much."""
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


SYSTEM = (
    "`quadrotor`, `module:attribute` or `file.py:attribute`; --help after it shows its own options "
    "too."
)
"""Help of the argument `system`."""
SET = "System option, key=value; where a flag has the same name, or in scripts."
"""Help of `--set`."""


def check_arguments(arguments: Sequence[str]) -> None:
    """Refuse arguments that can name nothing; they would fail later, and garble the terminal."""
    for before, argument in pairwise(("", *arguments)):
        flag = f"{before} " if before.startswith("--") and "=" not in before else ""
        # A word without a flag is named by what reads it.
        if (flag and not argument) or re.fullmatch(r"--[\w-]+=", argument):
            said = argument or f"{flag}''"
            raise UserError(f"the argument {said} is empty: give a value, or leave it out.")
        if steers(argument):
            raise UserError(
                f"the argument '{one_line(argument)}' holds control characters or is not UTF-8 "
                "text: write it without them."
            )
        if len(argument.encode()) > _LONGEST:
            raise UserError(
                f"the argument '{one_line(argument)}' is too long: write at most {_LONGEST} bytes."
            )


_Read = TypeVar("_Read")


def read(how: Callable[[str], _Read], text: str, flag: str) -> _Read:
    """Read the text of a flag; `UserError` with its name for what `how` refuses."""
    try:
        return how(text)
    except ValueError as error:
        raise UserError(f"{flag}: {error}.") from None


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
