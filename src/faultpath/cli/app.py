"""The verbs of the `faultpath` command.

Nothing heavy is imported here: torch and the statistics load when a verb needs them, so that
`--help` answers at once.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from inspect import getdoc, signature
from typing import Annotated, Any

import typer

from faultpath.cli import replay, runs, systems
from faultpath.cli.flags import with_system_flags
from faultpath.cli.options import Verbs
from faultpath.core import __version__

_TOY = "examples/toy.py:create"
_ASKED = f"{_TOY} --baseline calibrated --repair blind --fault gain:scale"


@dataclass(frozen=True)
class Command:
    """A verb, as the table below names it."""

    name: str
    command: Callable[..., Any]
    example: str
    """Arguments that follow the name in a call."""
    line: str = ""
    """Its line in the list of all verbs; by default its help."""


_PANELS = {
    "Begin here": (
        Command("demo", runs.demo, "--out runs/demo", "Audit a small system that ships along."),
        Command("init", systems.init, "mine --with numpy", "Write a system of your own to start."),
        Command("check", systems.check, _TOY, "Check that a system can be audited."),
        Command(
            "audit",
            runs.audit,
            f"{_ASKED}=0.6 --library carts",
            "Compare a repair with a baseline, module by module and shared.",
        ),
        Command(
            "judge",
            runs.judge,
            "results.csv --baseline old --repair new",
            "Compare two versions in trials that other tools ran.",
        ),
        Command(
            "report",
            runs.report,
            "runs/one runs/two --out comparison.html",
            "Write the pages of finished runs, or compare them.",
        ),
    ),
    "More": (
        Command("trace", systems.trace, _TOY, "Show which module reads which source."),
        Command(
            "map",
            runs.reversal_map,
            f"{_ASKED} --against controller,observer --up-to 0.4 --library carts",
            "Compare over the errors of two modules.",
        ),
        Command(
            "scan",
            runs.scan,
            f"{_TOY} --variant calibrated --fault gain:scale=1.2 --library carts",
            "Find which errors of a system's inputs cancel.",
        ),
        Command(
            "replay",
            replay.replay,
            "runs/mine --scene cart/003 --where",
            "Run trials again and compare them to the bit.",
        ),
    ),
}
"""The engine's verbs, by the heading under which the help shows them."""


@cache
def panels() -> dict[str, tuple[Command, ...]]:
    """Return all verbs: the engine's, and what installed distributions add.

    An entry point in the group `faultpath.verbs` is a verb's name, and a function with options or a
    `Verbs` as its value; the module holds an `EXAMPLE` of what follows the name in a call.
    """
    added = tuple(
        Command(point.name, point.load(), import_module(point.module).EXAMPLE)
        for point in sorted(entry_points(group="faultpath.verbs"), key=lambda entry: entry.name)
    )
    return _PANELS | ({"Installed with a system": added} if added else {})


def build(arguments: Sequence[str] = ()) -> typer.Typer:
    """Return the command for a line of arguments: the verbs that take a system get its flags.

    Raises as `with_system_flags`.
    """
    app = Verbs(
        name="faultpath", no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False
    )
    app.callback()(everywhere)
    verb, *rest = arguments or ("",)
    for panel, entries in panels().items():
        for entry in entries:
            example = f"Example: faultpath {entry.name} {entry.example}"
            shown: dict[str, Any] = {"rich_help_panel": panel, "epilog": example}
            command = entry.command
            if isinstance(command, typer.Typer):
                app.add_typer(command, name=entry.name, **shown)
                continue
            if entry.name == verb and {"system", "options"} <= {*signature(command).parameters}:
                command = with_system_flags(verb, command, rest)
            # Typer would keep the line breaks of a docstring.
            text = " ".join((getdoc(command) or "").split())
            line = entry.line or text
            app.command(entry.name, help=text, short_help=line, **shown)(command)
    return app


def _print_version(requested: bool) -> None:
    if requested:
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
        bool,
        typer.Option("--version", is_eager=True, callback=_print_version, help="Show the version."),
    ] = False,
) -> None:
    """Audit whether a repair still helps when a fault reaches every module that shares its
    source."""
    del traceback, version  # `main` takes the one out of the arguments, wherever it stands
