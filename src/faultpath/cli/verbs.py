"""What all verbs have in common."""

from typing import Any

import typer
from typer.core import TyperCommand, TyperOption

from faultpath.errors import UserError


class Verb(TyperCommand):
    """A verb that takes every option once, but for those that take several values."""

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

    def command(self, name: str | None = None, **settings: Any) -> Any:
        """Register a function as a verb; `settings` are those of typer."""
        return super().command(name, cls=Verb, **settings)


def _single(parameter: object) -> bool:
    return isinstance(parameter, TyperOption) and not parameter.multiple
