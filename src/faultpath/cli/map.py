"""`faultpath map`: who is ahead over the errors at two modules of one source."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import (
    FAILED_TRIALS,
    SET,
    Executor,
    Share,
    TimeLimit,
    names,
    numbers,
    path,
    settings,
    sizes,
)


def command(
    system: Annotated[
        str, typer.Argument(help="As for `audit`; --help after it shows its own options too.")
    ],
    baseline: Annotated[str, typer.Option(help="Variant to compare with.")],
    repair: Annotated[str, typer.Option(help="Variant that is meant to help.")],
    fault: Annotated[
        str,
        typer.Option(
            help="Without its size: `calibration`, `gain`, `gain:offset`, `gain,onset=9`."
        ),
    ],
    against: Annotated[
        str, typer.Option(help="The two modules whose errors are mapped: reconstruction,predictor.")
    ],
    up_to: Annotated[
        float | None,
        typer.Option(help="Largest error, of either sign; default three declared spreads."),
    ] = None,
    points: Annotated[
        int, typer.Option(help="Pairs of errors at most, but for those that bisect the paths.")
    ] = 81,
    mean: Annotated[
        str, typer.Option(help="Mean of the errors, one number or one for each module.")
    ] = "0",
    spread: Annotated[
        str | None,
        typer.Option(help="Standard deviation of the errors, likewise; default as declared."),
    ] = None,
    correlation: Annotated[
        float | None, typer.Option(help="Of the errors, to tell the expected difference there.")
    ] = None,
    library: Annotated[str, typer.Option(help="Library of scenes.")] = "held-out",
    scenes: Annotated[int | None, typer.Option(help="Run only the first N scenes.")] = None,
    seeds: Annotated[
        str, typer.Option(help="Seeds of the noise, and of trained models where there are any.")
    ] = "0",
    set_: Annotated[list[str] | None, typer.Option("--set", help=SET)] = None,
    out: Annotated[
        Path | None, typer.Option(parser=path, help="Run folder; default runs/<question>-<code>.")
    ] = None,
    share: Share = None,
    workers: Annotated[
        int | None, typer.Option(help="Worker processes, 0 for this process alone.")
    ] = None,
    executor: Executor = "local",
    time_limit: TimeLimit = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
) -> int:
    """Map the success difference over the error at one module and that at another: where repair
    or baseline is ahead, from which correlation of the errors on, and which error turns it."""
    drawn, options = numbers(seeds, "--seeds"), settings(set_ or [])
    means = sizes(mean, "--mean")
    spreads = None if spread is None else sizes(spread, "--spread")

    from faultpath.door.display import Display, SafeConsole
    from faultpath.door.mapping import reversal_map

    console = SafeConsole()
    run = reversal_map(
        system,
        baseline=baseline,
        repair=repair,
        fault=fault,
        against=names(against, "--against"),
        up_to=up_to,
        points=points,
        mean=means,
        spread=spreads,
        correlation=correlation,
        library=library,
        scenes=scenes,
        seeds=drawn,
        options=options,
        folder=out,
        share=share,
        workers=workers,
        executor=executor,
        time_limit_s=time_limit,
        progress=Display(SafeConsole(stderr=as_json), ("faultpath", *sys.argv[1:])),
    )

    from faultpath.report.plane import shown

    if as_json:
        typer.echo(run.record.model_dump_json(indent=1))
    else:
        console.print(shown(run.record))
        console.print(f"Report: {run.folder / 'report.html'}", markup=False, soft_wrap=True)
    return FAILED_TRIALS if run.record.failed else 0
