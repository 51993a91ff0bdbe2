"""Common parts of all commands: how they are registered, what they take, how they end."""

import re
import sys
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand, TyperOption

from faultpath.core.errors import UserError
from faultpath.core.files.opening import named_path
from faultpath.core.text import has_control_characters, number_in, one_line, whole_in

if TYPE_CHECKING:
    from faultpath.api.display import Display

_LONGEST = 4096
"""Longest path that Linux takes; nothing else that is asked for needs as much."""
FOUND = 1
"""Exit status of a verb that finished, and found what must not be: failed trials, a failed check,
trials that do not repeat."""

_READ: Mapping[Any, Callable[[str], object]] = {int: whole_in, float: number_in}

SystemName = Annotated[
    str,
    typer.Argument(
        help="`quadrotor`, `module:attribute` or `file.py:attribute`; --help after it shows its "
        "own options too."
    ),
]
Json = Annotated[
    bool,
    typer.Option("--json", help="Print the result as JSON, alone on standard output."),
]


def display() -> "Display":
    """Return where a command shows what it does: on standard error, apart from its result."""
    from faultpath.api.display import Display, SafeConsole

    return Display(SafeConsole(stderr=True), ("faultpath", *sys.argv[1:]))


def check_arguments(arguments: Sequence[str]) -> None:
    """Refuse arguments that can name nothing; they would fail later, and garble the terminal."""
    for before, argument in pairwise(("", *arguments)):
        flag = f"{before} " if before.startswith("--") and "=" not in before else ""
        # A word without a flag is named by what reads it.
        if (flag and not argument) or re.fullmatch(r"--[\w-]+=", argument):
            label = argument or f"{flag}''"
            raise UserError(f"the argument {label} is empty: give a value, or leave it out.")
        if has_control_characters(argument):
            raise UserError(
                f"the argument '{one_line(argument)}' holds control characters or is not UTF-8 "
                "text: write it without them."
            )
        if len(argument.encode()) > _LONGEST:
            raise UserError(
                f"the argument '{one_line(argument)}' is too long: write at most {_LONGEST} bytes."
            )


def refuse_with(other: str, **arguments: object) -> None:
    """Raise `UserError` for options that were given and do nothing beside another one."""
    idle = [f"--{name.replace('_', '-')}" for name, value in arguments.items() if value is not None]
    if idle:
        raise UserError(f"{' and '.join(idle)} would do nothing with {other}: leave it out.")


def path(text: str | Path) -> Path:
    """Read the path of a file or folder: `parser=` of every option and argument that is one."""
    try:
        return named_path(text)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None


def literal(text: str) -> str:
    """Escape what a help takes for markup: `[...]` for a style, `:factory:` for a picture."""
    from rich.markup import escape

    return escape(text).replace(":", "[none]:[/none]")


def as_written(command: Any) -> None:
    """Let all texts of a command and of those below it stand in its help as they are written."""
    for item in (command, *command.params):
        for name in ("help", "short_help", "epilog"):
            if text := getattr(item, name, None):
                setattr(item, name, literal(text))
    for item in getattr(command, "commands", {}).values():
        as_written(item)


class Verb(TyperCommand):
    """A verb that takes every option once, but for those that take several values, and numbers as
    any file gives them."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse as any command does; `UserError` for an option given twice, or for no number."""
        if args:
            try:
                values, _, options = self.make_parser(ctx).parse_args(list(args))
            except typer.TyperException as error:
                vars(error)["ctx"] = ctx  # which names the command to ask for help
                raise
            for option in options:
                if not isinstance(option, TyperOption) or option.multiple:
                    continue
                if sum(other is option for other in options) > 1:
                    raise UserError(f"{option.opts[0]} is given twice: give it once.")
                value = values[option.name]
                kind: Any = option.type_descriptor.annotation
                try:
                    _READ.get(kind, str)(value)
                except ValueError as error:
                    wrong = f"'{one_line(value)}', give {error}"
                    raise typer.BadParameter(wrong, ctx=ctx, param=option) from None
        return super().parse_args(ctx, args)


class Verbs(typer.Typer):
    """A group of verbs."""

    def command(self, name: str | None = None, **settings: Any) -> Any:
        """Register a function as a verb; `settings` are those of typer."""
        return super().command(name, cls=Verb, **settings)
