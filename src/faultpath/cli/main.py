"""Entry point of the `faultpath` command.

Nothing heavy is imported here: torch and the statistics load when a verb needs them, so that
`--help` answers at once.
"""

import sys

import click
import typer

from faultpath.cli import audit, interface, report, scenes
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
app.command("interface")(interface.command)
app.command("report")(report.command)
app.add_typer(scenes.app, name="scenes")

USER_ERROR = 2
INTERRUPTED = 130


def main() -> None:
    """Run the command line; a user's mistake ends in one sentence and status 2."""
    try:
        status = app(standalone_mode=False)
    except UserError as error:
        typer.echo(f"faultpath: {error}", err=True)
        sys.exit(USER_ERROR)
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except (click.Abort, KeyboardInterrupt):
        typer.echo("faultpath: interrupted.", err=True)
        sys.exit(INTERRUPTED)
    sys.exit(status if isinstance(status, int) else 0)
