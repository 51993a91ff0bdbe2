"""`faultpath audit`: run the arms of one question, decide, report."""

import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

from faultpath.cli.options import SET, TimeLimit, numbers, path, settings

FAILED_TRIALS = 1


def command(
    system: Annotated[
        str,
        typer.Argument(
            help="`quadrotor`, `module:attribute` or `file.py:attribute`; --help after it shows "
            "its own options too."
        ),
    ],
    baseline: Annotated[
        str,
        typer.Option(help="Variant to compare with; for the quadrotor also your file.py:factory."),
    ],
    repair: Annotated[str, typer.Option(help="Variant that is meant to help, named likewise.")],
    fault: Annotated[
        str,
        typer.Option(
            help="`calibration=+0.1`, `mass:scale=1.1`, `wind:delay=5@predictor,onset=20`, ..."
        ),
    ],
    library: Annotated[str, typer.Option(help="Library of scenes.")] = "held-out",
    scenes: Annotated[int | None, typer.Option(help="Run only the first N scenes.")] = None,
    seeds: Annotated[
        str, typer.Option(help="Seeds of the noise, and of trained models where there are any.")
    ] = "0",
    primary: Annotated[
        str | None,
        typer.Option(help="Path of the primary contrast, a module or shared (default)."),
    ] = None,
    generalise: Annotated[
        Literal["scenes", "models"],
        typer.Option(
            help="What intervals speak of: new scenes, or newly trained models too (several seeds)."
        ),
    ] = "scenes",
    set_: Annotated[list[str] | None, typer.Option("--set", help=SET)] = None,
    out: Annotated[
        Path | None, typer.Option(parser=path, help="Run folder; default runs/<question>-<code>.")
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            help="Worker processes, 0 for this process alone; default one per core if that helps."
        ),
    ] = None,
    time_limit: TimeLimit = None,
) -> int:
    """Audit a repair against a baseline under correct inputs, under the fault at each module
    alone, and under the shared fault."""
    drawn, options = numbers(seeds, "--seeds"), settings(set_ or [])

    from faultpath.door.audit import audit
    from faultpath.door.display import Display, SafeConsole

    console = SafeConsole()
    run = audit(
        system,
        baseline=baseline,
        repair=repair,
        fault=fault,
        library=library,
        scenes=scenes,
        seeds=drawn,
        primary=primary,
        generalise=generalise,
        options=options,
        folder=out,
        workers=workers,
        time_limit_s=time_limit,
        progress=Display(console, ("faultpath", *sys.argv[1:])),
    )

    from faultpath.report.terminal import decision

    console.print(decision(run.record))
    console.print(f"Report: {run.folder / 'report.html'}", markup=False, soft_wrap=True)
    return FAILED_TRIALS if run.failed else 0
