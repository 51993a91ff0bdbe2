"""`faultpath scenes`: libraries of the quadrotor."""

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(help="Libraries of scenes for the quadrotor.", no_args_is_help=True)


@app.command("generate")
def generate(
    out: Annotated[Path, typer.Argument(help="File to write, for example mine.json.gz.")],
    seed: Annotated[int, typer.Option(help="Seed of the library.")],
    count: Annotated[int, typer.Option(help="Number of scenes.")] = 100,
) -> None:
    """Generate a library from a seed; audits take the file as `--library`."""
    from faultpath.quadrotor.scenes.library import write_library

    write_library(out, seed=seed, count=count, name=out.name.partition(".")[0])
    typer.echo(f"Written: {out}")


@app.command("list")
def show(
    library: Annotated[str, typer.Argument(help="Name or file of a library.")] = "held-out",
) -> None:
    """List the scenes of a library."""
    from faultpath.quadrotor.scenes.library import load_library

    for scene in load_library(library).scenes:
        typer.echo(f"{scene.id}  {scene.topology}")
