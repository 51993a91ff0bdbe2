"""`faultpath scenes`: libraries of the quadrotor."""

import time
from collections import Counter
from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import LARGEST, path
from faultpath.cli.verbs import Verbs

MOST_SCENES = 10_000
"""A library of more takes hours to make; statistics need a few hundred."""

app = Verbs(help="Libraries of scenes for the quadrotor.", no_args_is_help=True)


@app.command("generate")
def generate(
    out: Annotated[Path, typer.Argument(parser=path, help="File to write, for example mine.json.")],
    seed: Annotated[int, typer.Option(min=0, max=LARGEST, help="Seed of the library.")],
    count: Annotated[int, typer.Option(max=MOST_SCENES, help="Number of scenes.")] = 100,
) -> None:
    """Generate a library from a seed; audits take the file as `--library`."""
    from faultpath.door.display import Display, Now, SafeConsole
    from faultpath.errors import UserError
    from faultpath.quadrotor.scenes.library import write_library

    name = out.name.partition(".")[0]
    if not name:
        raise UserError(f"the file {str(out)!r} gives the library no name: call it mine.json, say.")
    began = time.monotonic()
    try:
        with Display(SafeConsole(stderr=True)).progress("Making scenes") as show:

            def note(made: int) -> None:
                left = (time.monotonic() - began) * (count - made) / max(1, made)
                show(Now(made, count, f"{made} of {count}", left))

            write_library(out, seed=seed, count=count, name=name, progress=note)
    except OSError as error:
        raise UserError(
            f"cannot write {out} ({error.strerror}): choose a place that you may write to."
        ) from error
    typer.echo(f"Written: {out}")


@app.command("list")
def show(
    library: Annotated[str, typer.Argument(help="Name or file of a library.")] = "held-out",
) -> None:
    """List the scenes of a library, and how many there are of each kind."""
    from faultpath.quadrotor.scenes.library import load_library

    scenes = load_library(library).scenes
    wide = max(len("Scene"), *(len(scene.id) for scene in scenes))
    for name, kind in (("Scene", "Kind"), *((scene.id, scene.topology) for scene in scenes)):
        typer.echo(f"{name:{wide}}  {kind}")
    kinds = Counter(scene.topology for scene in scenes)
    counts = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
    typer.echo(f"{len(scenes)} scenes: {counts}")
