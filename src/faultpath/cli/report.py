"""`faultpath report`: make the pages of a finished run again."""

from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import path
from faultpath.errors import UserError


def command(
    folder: Annotated[Path, typer.Argument(parser=path, help="Folder of a finished audit or map.")],
) -> None:
    """Write the report and tables of a run again from its folder; runs no code from it."""
    # What draws takes a second to load, and a wrong folder need not wait.
    if not (folder / "provenance.json").exists():
        raise UserError(f"{folder} holds no provenance.json: give the folder of a finished run.")

    from faultpath.door.reproduced import ReproductionRun
    from faultpath.door.run import open_run

    run = open_run(folder)
    if isinstance(run, ReproductionRun):
        raise UserError(
            f"{folder} holds a reproduction, whose pages stand in it: give an audit or a map."
        )
    for written in run.report():
        typer.echo(written)
