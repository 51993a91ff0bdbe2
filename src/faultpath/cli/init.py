"""`faultpath init`: a system of one's own to begin with, and its test."""

from pathlib import Path
from typing import Annotated, Literal

import typer


def command(
    name: Annotated[str, typer.Argument(help="Of the system; its file is NAME.py.")],
    kind: Annotated[
        Literal["numpy", "torch", "gymnasium"],
        typer.Option("--with", help="What it is written with."),
    ] = "numpy",
) -> int:
    """Write a system that flies, and its test, into the working directory."""
    from faultpath.systems.init import TEMPLATES, write_system

    system, test = write_system(name, kind, Path())
    baseline, parameter = TEMPLATES[kind]
    typer.echo(
        f"Wrote {system} and {test}. Next:\n"
        f"  faultpath audit {system}:create --baseline {baseline} "
        f"--repair typical --fault {parameter}:scale=0.6\n"
        f"  python -m pytest {test}"
    )
    return 0
