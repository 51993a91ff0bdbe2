"""What all verbs have in common."""

from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup, TyperOption

from faultpath.core.errors import UserError


def literal(text: str) -> str:
    """Escape what a help takes for markup: `[...]` for a style, `:factory:` for a picture."""
    from rich.markup import escape

    return escape(text).replace(":", "[none]:[/none]")


def _as_written(command: Any) -> None:
    """Let all texts of a command stand in its help as they are written."""
    for each in (command, *getattr(command, "commands", {}).values(), *command.params):
        for name in ("help", "short_help", "epilog"):
            if text := getattr(each, name, None):
                setattr(each, name, literal(text))


class _Group(TyperGroup):
    def format_help(self, ctx: Any, formatter: Any) -> None:
        _as_written(self)
        super().format_help(ctx, formatter)


class Verb(TyperCommand):
    """A verb that takes every option once, but for those that take several values."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write the help; nothing in it is markup."""
        _as_written(self)
        super().format_help(ctx, formatter)

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse as any command does; `UserError` for an option given twice."""
        if args:
            _, _, given = self.make_parser(ctx).parse_args(list(args))
            for option in given:
                if _single(option) and sum(each is option for each in given) > 1:
                    raise UserError(f"{option.opts[0]} is given twice: give it once.")
        return super().parse_args(ctx, args)


class Verbs(typer.Typer):
    """A group of verbs."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(cls=_Group, **settings)

    def command(self, name: str | None = None, **settings: Any) -> Any:
        """Register a function as a verb; `settings` are those of typer."""
        return super().command(name, cls=Verb, **settings)


def _single(parameter: object) -> bool:
    return isinstance(parameter, TyperOption) and not parameter.multiple
