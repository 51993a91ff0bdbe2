"""The verbs of the `faultpath` command.

Nothing heavy is imported here: torch and the statistics load when a verb needs them, so that
`--help` answers at once.
"""

from collections.abc import Callable, Mapping, Sequence
from inspect import getdoc
from typing import Annotated, Any

import typer

from faultpath.cli import (
    audit,
    check,
    claims,
    compare,
    init,
    interface,
    log,
    map,
    plan,
    probe,
    replay,
    report,
    reproduce,
    runs,
    scenes,
    selfcheck,
    study,
    trace,
    train,
)
from faultpath.cli.system_flags import with_system_flags
from faultpath.cli.verbs import Verbs
from faultpath.version import __version__


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
    for panel, verbs in _PANELS.items():
        for name in verbs:
            command = _COMMANDS[name]
            if name == "audit" and any(part.partition("=")[0] == "--study" for part in rest):
                command = study.command  # the file says all that the verb takes otherwise
            shown: dict[str, Any] = {
                "rich_help_panel": panel,
                "epilog": f"Example: {EXAMPLES[name]}",
            }
            if isinstance(command, typer.Typer):
                app.add_typer(command, name=name, **shown)
                continue
            # Typer would keep the line breaks of a docstring.
            said = " ".join((getdoc(command) or "").split())
            if name == verb and name in _OF_SYSTEMS and command is not study.command:
                command = with_system_flags(name, command, rest)
            app.command(name, help=said, **shown)(command)
    return app


_OF_SYSTEMS = ("audit", "check", "interface", "map", "plan", "probe", "trace")
_COMMANDS: Mapping[str, Callable[..., int | None] | typer.Typer] = {
    "audit": audit.command,
    "check": check.command,
    "claims": claims.command,
    "compare": compare.command,
    "init": init.command,
    "interface": interface.command,
    "log": log.command,
    "map": map.command,
    "plan": plan.command,
    "probe": probe.command,
    "replay": replay.command,
    "report": report.command,
    "reproduce": reproduce.command,
    "runs": runs.command,
    "scenes": scenes.app,
    "selfcheck": selfcheck.app,
    "trace": trace.command,
    "train": train.app,
}
_PANELS = {
    "Your system": ("init", "interface", "trace", "check"),
    "Audits": ("plan", "audit", "map", "probe", "log"),
    "Finished runs": ("runs", "compare", "report", "replay"),
    "The paper and its quadrotor": ("claims", "reproduce", "scenes", "train"),
    "faultpath itself": ("selfcheck",),
}

EXAMPLES = {
    "audit": "faultpath audit examples/toy.py:create --baseline calibrated --repair blind "
    "--fault gain:scale=0.6 --library carts",
    "check": "faultpath check examples/toy.py:create",
    "claims": "faultpath claims",
    "compare": "faultpath compare runs/one runs/two --out comparison.html",
    "init": "faultpath init mine --with numpy",
    "interface": "faultpath interface examples/toy.py:create",
    "log": "faultpath log flight.ulg --columns px4 --mass 1.5",
    "map": "faultpath map examples/toy.py:create --baseline calibrated --repair blind "
    "--fault gain:scale --against controller,observer --up-to 0.4 --library carts",
    "plan": "faultpath plan examples/toy.py:create --baseline calibrated --repair blind "
    "--fault gain:scale=0.6 --library carts",
    "probe": "faultpath probe quadrotor --variants wm-a,wm-a+dcc --perturb calibration=+0.1",
    "replay": "faultpath replay runs/mine --scene cart/003 --signals",
    "report": "faultpath report runs/mine",
    "reproduce": "faultpath reproduce table-4",
    "runs": "faultpath runs",
    "scenes": "faultpath scenes generate mine.json --seed 7",
    "selfcheck": "faultpath selfcheck statistics --profile quick",
    "trace": "faultpath trace examples/toy.py:create",
    "train": "faultpath train quadrotor gru gru+dcc --seed 0",
}
"""One line a verb that shows how it is called."""


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
