"""`faultpath train`: fit the learned models of the quadrotor."""

import os
from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import path, refuse_with
from faultpath.cli.verbs import Verbs
from faultpath.trials.question import LARGEST

EXAMPLE = "faultpath train quadrotor gru gru+dcc --seed 0"
FAILED_MODELS = 1

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
    from faultpath_quadrotor.verbs.fitting import TrainRequest, list_models, train

    if list_:
        refuse_with(
            "--list",
            names=names or None,
            seed=seeds or None,
            data=data,
            out=out,
            workers=workers,
            ship=ship or None,
        )
        list_models()
        return 0
    request = TrainRequest(
        names=tuple(names or ()),
        seeds=tuple(seeds or ()),
        data=data or Path("data"),
        out=out or Path("runs/train"),
        workers=(os.cpu_count() or 1) if workers is None else workers,
        ship=ship,
    )
    return FAILED_MODELS if train(request) else 0
