"""`faultpath report`: make the pages of a finished run again."""

from pathlib import Path
from typing import Annotated

import typer


def command(
    folder: Annotated[Path, typer.Argument(help="Folder of a finished audit.")],
) -> None:
    """Write report and tables of a run again from its stored outcomes."""
    from faultpath.cli.pages import read_record, save_pages
    from faultpath.trials import SystemSpec, load_system

    question = read_record(folder).question
    system = load_system(SystemSpec(name=question.system, options=question.options))
    for path in save_pages(system, folder):
        typer.echo(path)
