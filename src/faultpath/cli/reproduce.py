"""`faultpath reproduce`: the paper's tables, figures and claims."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import TimeLimit, path, worker_count

FAILED_TRIALS = 1


def command(
    pages: Annotated[
        list[str] | None, typer.Argument(help="`table-4`, `figure-3`, `text-wind`, …; default all.")
    ] = None,
    profile: Annotated[
        str, typer.Option(help="quick (few scenes, one seed) or paper (its size).")
    ] = "quick",
    out: Annotated[
        Path | None, typer.Option(parser=path, help="Run folder; default runs/<name>-<code>.")
    ] = None,
    library: Annotated[
        str | None,
        typer.Option(help="Library or file to fly in place of the held-out library."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(help="Worker processes; default one a core, or one a GPU.")
    ] = None,
    device: Annotated[str | None, typer.Option(help="cpu (default) or cuda.")] = None,
    time_limit: TimeLimit = None,
) -> int:
    """Fly every study of the paper, or some of its pages, and set the results beside it."""
    from faultpath.studies.run import plan, standing

    options = {} if device is None else {"device": device}
    asked = plan(pages or (), profile, standing(library), options)
    own = "" if library is None else f"-{Path(library).stem}"
    name = f"reproduction{own}-{asked.profile.name}"
    folder, other = (out, "") if out else asked.folder(name)

    from faultpath.cli.studies import carry_out, tell

    line = ("faultpath", *sys.argv[1:])
    done = carry_out(
        asked,
        folder,
        worker_count(asked.system, workers),
        line,
        first=other,
        time_limit_s=time_limit,
    )
    tell(asked, done)
    return FAILED_TRIALS if done.reproduction.failed_trials else 0
