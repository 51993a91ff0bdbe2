"""The verbs of the `faultpath` command.

Nothing heavy is imported here: torch and the statistics load when a verb needs them, so that
`--help` answers at once.
"""

from collections.abc import Sequence
from typing import Annotated

import typer

from faultpath.cli import (
    audit,
    check,
    claims,
    init,
    interface,
    log,
    map,
    probe,
    report,
    reproduce,
    scenes,
    selfcheck,
    trace,
    train,
)
from faultpath.cli.system_flags import with_system_flags
from faultpath.cli.verbs import Verbs


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
    for name, command in _OF_SYSTEMS.items():
        app.command(name)(with_system_flags(name, command, rest) if name == verb else command)
    for name, command in _OTHERS.items():
        app.command(name)(command)
    for name, verbs in _GROUPS.items():
        app.add_typer(verbs, name=name)
    return app


_OF_SYSTEMS = {
    "audit": audit.command,
    "check": check.command,
    "interface": interface.command,
    "map": map.command,
    "probe": probe.command,
    "trace": trace.command,
}
_OTHERS = {
    "claims": claims.command,
    "init": init.command,
    "log": log.command,
    "report": report.command,
    "reproduce": reproduce.command,
}
_GROUPS = {"scenes": scenes.app, "selfcheck": selfcheck.app, "train": train.app}


def everywhere(
    traceback: Annotated[
        bool,
        typer.Option(
            "--traceback", help="Show the whole traceback of an error; works with every command."
        ),
    ] = False,
) -> None:
    """Audit whether a repair still helps when a fault reaches every module that shares its
    source."""
    del traceback  # `main` takes it out of the arguments, wherever it stands
