"""The verbs of the `faultpath` command.

Nothing heavy is imported here: torch and the statistics load when a verb needs them, so that
`--help` answers at once.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from inspect import getdoc
from typing import Annotated, Any

import typer

from faultpath.cli.system_flags import with_system_flags
from faultpath.cli.verbs import Verbs
from faultpath.core.version import __version__

_TOY = "examples/toy.py:create"
_ARMS = "--baseline calibrated --repair blind"


@dataclass(frozen=True)
class Entry:
    """A verb, as the table below names it."""

    name: str
    example: str
    """How it is called."""
    home: str
    """Module and attribute."""
    of_a_system: bool = False
    """Whether it takes the flags of the system that its line names."""


def _entry(name: str, example: str, of_a_system: bool = False) -> Entry:
    home = f"faultpath.cli.{name}:command"
    return Entry(name, f"faultpath {name} {example}".rstrip(), home, of_a_system)


_PANELS = {
    "Your system": (
        _entry("init", "mine --with numpy"),
        _entry("trace", _TOY, of_a_system=True),
        _entry("check", _TOY, of_a_system=True),
    ),
    "Audits": (
        _entry("plan", f"{_TOY} {_ARMS} --fault gain:scale=0.6 --library carts", of_a_system=True),
        _entry("audit", f"{_TOY} {_ARMS} --fault gain:scale=0.6 --library carts", of_a_system=True),
        _entry(
            "map",
            f"{_TOY} {_ARMS} --fault gain:scale --against controller,observer --up-to 0.4 "
            "--library carts",
            of_a_system=True,
        ),
        _entry("log", "flight.ulg --columns px4 --mass 1.5"),
    ),
    "Finished runs": (
        _entry("report", "runs/one runs/two --out comparison.html"),
        _entry("replay", "runs/mine --scene cart/003 --signals"),
    ),
}
"""The engine's verbs, by the heading under which the help shows them."""


@cache
def panels() -> dict[str, tuple[Entry, ...]]:
    """Return all verbs: the engine's, and what installed distributions add.

    An entry point in the group `faultpath.verbs` is a verb's name, and a function with options or a
    `Verbs` as its value; the module holds an `EXAMPLE` of a call.
    """
    added = tuple(
        Entry(point.name, import_module(point.module).EXAMPLE, point.value)
        for point in sorted(entry_points(group="faultpath.verbs"), key=lambda each: each.name)
    )
    return _PANELS | ({"Installed with a system": added} if added else {})


def build(arguments: Sequence[str] = ()) -> typer.Typer:
    """Return the command for a line of arguments: the verbs that take a system get its flags.

    Raises as `with_system_flags`.
    """
    app = Verbs(
        name="faultpath",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
    )
    app.callback()(everywhere)
    verb, *rest = arguments or ("",)
    for panel, entries in panels().items():
        for entry in entries:
            command = _command(entry, rest if entry.name == verb else None)
            shown: dict[str, Any] = {
                "rich_help_panel": panel,
                "epilog": f"Example: {entry.example}",
            }
            if isinstance(command, typer.Typer):
                app.add_typer(command, name=entry.name, **shown)
                continue
            # Typer would keep the line breaks of a docstring.
            said = " ".join((getdoc(command) or "").split())
            app.command(entry.name, help=said, **shown)(command)
    return app


def _command(entry: Entry, rest: Sequence[str] | None) -> Callable[..., int | None] | typer.Typer:
    module, attribute = entry.home.split(":")
    if entry.name == "audit" and any(part.partition("=")[0] == "--study" for part in rest or ()):
        module, attribute = "faultpath.cli.audit", "study"  # the file says all that flags would
    found = getattr(import_module(module), attribute)
    if attribute == "study":
        return found
    if rest is not None and entry.of_a_system:
        return with_system_flags(entry.name, found, rest)
    return found


def _tell(asked: bool) -> None:
    if asked:
        typer.echo(f"faultpath {__version__}")
        raise typer.Exit


def everywhere(
    traceback: Annotated[
        bool,
        typer.Option(
            "--traceback", help="Show the whole traceback of an error; works with every command."
        ),
    ] = False,
    version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_tell, help="Show the version.")
    ] = False,
) -> None:
    """Audit whether a repair still helps when a fault reaches every module that shares its
    source."""
    del traceback, version  # `main` takes the one out of the arguments, wherever it stands
