"""The verbs of the `faultpath` command.

Nothing heavy is imported here: torch and the statistics load when a verb needs them, so that
`--help` answers at once.
"""

from typing import Annotated

import typer

from faultpath.cli import (
    audit,
    claims,
    interface,
    probe,
    report,
    reproduce,
    scenes,
    selfcheck,
    train,
)
from faultpath.cli.verbs import Verbs

app = Verbs(
    name="faultpath",
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
app.add_typer(selfcheck.app, name="selfcheck")
app.add_typer(train.app, name="train")


@app.callback()
def everywhere(
    traceback: Annotated[
        bool,
        typer.Option(
            "--traceback", help="Show all that is known of an error; goes with every command."
        ),
    ] = False,
) -> None:
    """Audit whether a repair still helps when a fault reaches every module that shares its
    source."""
    del traceback  # `main` takes it out of the arguments, wherever it stands
