"""Entry point of the `faultpath` command.

Nothing heavy is imported here: torch and the statistics load when a verb needs them, so that
`--help` answers at once.
"""

import sys
from typing import NoReturn

import typer

from faultpath.cli import audit, claims, interface, probe, report, reproduce, scenes, train
from faultpath.cli.options import Stopped
from faultpath.errors import UserError

app = typer.Typer(
    name="faultpath",
    help="Audit whether a repair still helps when a fault reaches every module that shares its "
    "source.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.command("audit")(audit.command)
app.command("claims")(claims.command)
app.command("interface")(interface.command)
app.command("probe")(probe.command)
app.command("report")(report.command)
app.command("reproduce")(reproduce.command)
app.add_typer(scenes.app, name="scenes")
app.add_typer(train.app, name="train")

USER_ERROR = 2
INTERRUPTED = 130
"""What shells report for a program that Ctrl-C ended; typer returns it as well."""


def main() -> None:
    """Run the command line; a user's mistake ends in one sentence and status 2."""
    try:
        status = app(prog_name="faultpath", standalone_mode=False)
    except Stopped as stop:
        _end(str(stop), INTERRUPTED)
    except UserError as error:
        _end(str(error), USER_ERROR)
    except typer.TyperException as error:
        _end(_sentence(error), USER_ERROR)
    if status == INTERRUPTED:
        _end("interrupted; the same command goes on from what is stored.", INTERRUPTED)
    sys.exit(status if isinstance(status, int) else 0)


def _end(sentence: str, status: int) -> NoReturn:
    if sentence:
        typer.echo(f"faultpath: {sentence}", err=True)
    sys.exit(status)


def _sentence(error: typer.TyperException) -> str:
    """Say what the parser of the arguments found wrong; nothing where it has shown the help."""
    said = error.format_message().strip().rstrip(".").replace(". ", ": ")
    if not said:
        return ""
    context = getattr(error, "ctx", None)
    command = getattr(context, "command_path", "faultpath")
    return f"{said[0].lower()}{said[1:]}; `{command} --help` shows what there is."
