"""`faultpath scenes`: libraries of the quadrotor."""

from collections.abc import Callable, Generator
from contextlib import contextmanager
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
    from faultpath.errors import UserError
    from faultpath.quadrotor.scenes.library import write_library

    name = out.name.partition(".")[0]
    if not name:
        raise UserError(f"the file {str(out)!r} gives the library no name: call it mine.json, say.")
    try:
        with _making(count) as made:
            write_library(out, seed=seed, count=count, name=name, progress=made)
    except OSError as error:
        raise UserError(
            f"cannot write {out} ({error.strerror}): choose a place that you may write to."
        ) from error
    typer.echo(f"Written: {out}")


@contextmanager
def _making(count: int) -> Generator[Callable[[int], None]]:
    """Show on the standard error how many scenes there are, and how long the others will take."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeRemainingColumn as TimeLeft

    from faultpath.door.display import SafeConsole

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeLeft(),
        TextColumn("left"),
    )
    bar = Progress(*columns, console=SafeConsole(stderr=True))
    task = bar.add_task("Making scenes", total=count)

    def show(made: int) -> None:
        bar.start()  # with the first scene: what is refused shows no bar
        bar.update(task, completed=made)

    try:
        yield show
    finally:
        if bar.live.is_started:
            bar.stop()


@app.command("list")
def show(
    library: Annotated[str, typer.Argument(help="Name or file of a library.")] = "held-out",
) -> None:
    """List the scenes of a library."""
    from faultpath.quadrotor.scenes.library import load_library

    for scene in load_library(library).scenes:
        typer.echo(f"{scene.id}  {scene.topology}")
