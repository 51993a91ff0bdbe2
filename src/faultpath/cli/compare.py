"""`faultpath compare`: finished audits side by side."""

from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import path


def command(
    runs: Annotated[
        list[Path], typer.Argument(parser=path, help="Folders of two or more finished audits.")
    ],
    out: Annotated[
        Path | None, typer.Option(parser=path, help="Write a page too, to this .html file.")
    ] = None,
) -> None:
    """Set finished audits side by side: effects path by path, what differs between the runs, and
    where they are decided in opposite directions."""
    from faultpath.door.comparing import compare

    compared = compare(runs)
    page = None if out is None else compared.report(out)

    from faultpath.door.display import SafeConsole
    from faultpath.report.comparison.page import shown

    console = SafeConsole()
    console.print(shown(compared.runs))
    if page is not None:
        console.print(f"Page: {page}", markup=False, soft_wrap=True)
