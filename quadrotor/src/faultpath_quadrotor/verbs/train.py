"""`faultpath train`: fit the learned models of the quadrotor.

The quadrotor, and torch with it, loads inside the functions.
"""

import os
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from faultpath.plugin.commands import FOUND, LARGEST, Stopped, Verbs, path, refuse_with

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

    from faultpath.plugin.results import SafeConsole, Table
    from faultpath_quadrotor.models import ModelCard
    from faultpath_quadrotor.training.catalogue import FitJob

EXAMPLE = "quadrotor gru gru+dcc --seed 0"

app = Verbs(help="Fit the learned models of the quadrotor.", no_args_is_help=True)


@app.command("quadrotor")
def command(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="NAME",
            help="Models or groups (predictors, reconstructions, all); default everything.",
        ),
    ] = None,
    seeds: Annotated[
        list[int] | None,
        typer.Option(
            "--seed", min=0, max=LARGEST, help="Seed, repeatable; default those of the paper."
        ),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(parser=path, help="Folder of the collected flights; default data."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(parser=path, help="Folder for the checkpoints; default runs/train."),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(help="Worker processes, 0 for this process alone; default one per core."),
    ] = None,
    ship: Annotated[
        bool, typer.Option("--ship", help="Copy finished checkpoints into the package.")
    ] = False,
    list_: Annotated[bool, typer.Option("--list", help="List the models and end.")] = False,
) -> int:
    """Fit models from wherever an earlier call left them; missing flights are collected first."""
    from faultpath.plugin.results import SafeConsole, drawn

    console, notices = SafeConsole(), SafeConsole(stderr=True)
    if list_:
        values = {"names": names or None, "seed": seeds or None, "ship": ship or None}
        refuse_with("--list", **values, data=data, out=out, workers=workers)
        console.print(drawn(_models()))
        return 0

    from faultpath.plugin.data import make_folder
    from faultpath_quadrotor.training.catalogue import choose, stages
    from faultpath_quadrotor.training.jobs import FitFailure, check_pilots, run_jobs

    data, out = data or Path("data"), out or Path("runs/train")
    workers = (os.cpu_count() or 1) if workers is None else workers
    chosen = choose(tuple(names or ()), tuple(seeds or ()))
    if not ship:
        check_pilots(chosen)
    for place in (out, data):
        make_folder(place)  # before the flights: none are needed where nothing can be stored
    status = 0
    for jobs in stages(chosen):  # models whose data are flown with other models come after those
        _collect(notices, jobs, data, workers)
        with _progress(notices) as bar:
            whole = bar.add_task("Fitting", total=1.0, news="")
            say = partial(notices.print, markup=False, soft_wrap=True)

            def show(done: float, news: str, bar: "Progress" = bar, task: "TaskID" = whole) -> None:
                bar.update(task, completed=done, news=news)

            results = run_jobs(jobs, data, out, workers, show, say, shipped=ship)
        for failure in (result for result in results if isinstance(result, FitFailure)):
            text = f"{failure.job.stem} was not fitted: {failure.error}"
            text += f" ({failure.details})" if failure.details else ""
            console.print(text, markup=False, style="bold red", soft_wrap=True)
            status = FOUND
        cards = [result for result in results if not isinstance(result, FitFailure)]
        if cards:
            console.print(drawn(result_table(cards), one_line=True))
            console.print(f"Checkpoints: {out}", markup=False, soft_wrap=True)
    return status


def _models() -> "Table":
    """Return the table of what can be fitted."""
    from faultpath.plugin.results import Table, line
    from faultpath_quadrotor.training.catalogue import ALL

    columns = ("seeds", "what it is")
    lines = tuple(line(e.name, ",".join(map(str, e.seeds)), e.description) for e in ALL)
    return Table(corner="model", columns=columns, words=columns, lines=lines)


def result_table(cards: "Sequence[ModelCard]") -> "Table":
    """Return the table of fitted models."""
    from faultpath.plugin.results import Table, line

    columns = ("seed", "parameters", "training loss", "validation", "time")
    lines = (
        line(
            card.name,
            *(str(card.seed), f"{card.parameters:,}", f"{card.training_loss[-1]:.4g}"),
            "{} {:.4g}".format(*next(iter(card.final.items()))),
            "{}:{:02d}".format(*divmod(round(card.duration_s), 60)),
        )
        for card in cards
    )
    return Table(title="Fitted models", corner="model", columns=columns, lines=tuple(lines))


def _collect(console: "SafeConsole", jobs: "Sequence[FitJob]", data: Path, workers: int) -> None:
    from faultpath_quadrotor.training.jobs import collect_missing, missing_pools

    missing = missing_pools(jobs, data)
    if not missing:
        return
    with _progress(console) as bar:
        tasks = {pool: bar.add_task(f"Collecting {pool}", total=None, news="") for pool in missing}

        def show(pool: str, done: float, total: float) -> None:
            news = f"{done / max(total, 1):.0%}"
            bar.update(tasks[pool], total=total, completed=done, news=news)

        try:
            collect_missing(missing, data, workers, show)
        except KeyboardInterrupt:
            raise Stopped(
                f"interrupted while collecting; what was flown is kept in {data}; run the same "
                "command again to resume."
            ) from None


def _progress(console: "SafeConsole") -> "Progress":
    from rich import progress

    return progress.Progress(
        *(progress.TextColumn("{task.description}"), progress.BarColumn()),
        *(progress.TextColumn("{task.fields[news]}"), progress.TimeElapsedColumn()),
        *(progress.TimeRemainingColumn(), progress.TextColumn("left")),
        console=console,
    )
