"""`faultpath report`: make the pages of a finished run again."""

from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import path


def command(
    folder: Annotated[Path, typer.Argument(parser=path, help="Folder of a finished audit.")],
) -> None:
    """Write report and tables of a run again from its stored outcomes."""
    from faultpath.cli.records import read_record
    from faultpath.trials import SystemSpec, load_system

    question = read_record(folder).question
    system = load_system(SystemSpec(name=question.system, options=question.options))

    from faultpath.cli.pages import save_pages  # loads what draws; no mistake so far waits for it

    for written in save_pages(system, folder):
        typer.echo(written)
