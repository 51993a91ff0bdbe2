"""`faultpath audit`: run the arms of one question, decide, report."""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from faultpath.cli.options import (
    FAILED_TRIALS,
    SET,
    Executor,
    Share,
    TimeLimit,
    numbers,
    path,
    settings,
    sizes,
)
from faultpath.text import one_line

if TYPE_CHECKING:
    from faultpath.door.display import SafeConsole
    from faultpath.door.run import Run

Json = Annotated[
    bool,
    typer.Option(
        "--json", help="Print folder and record of each audit as JSON; words go to stderr."
    ),
]


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
            help="`calibration=+0.1`, `wind:delay=5@predictor`, `gain:scale=2,onset=20`, ...; "
            "several sizes, `mass:scale=0.9,1.1` or `calibration=-0.2..0.2/9`, are an audit each."
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
    metric: Annotated[str, typer.Option(help="Metric of the system to tell beside success.")] = "",
    thresholds: Annotated[
        str | None, typer.Option(help="Of that metric, to tell success anew: 0.02,0.05,0.1.")
    ] = None,
    stop_when: Annotated[
        Literal["decided", "all-decided"] | None,
        typer.Option(
            help="Stop once the primary contrast is decided, or the effect on every path: scenes "
            "in random order, --scenes is the most that are flown."
        ),
    ] = None,
    margin: Annotated[
        float | None,
        typer.Option(
            help="With --stop-when: a difference shown to be smaller than so many percentage "
            "points ends it too."
        ),
    ] = None,
    rule: Annotated[
        Literal["exact", "unconditional"],
        typer.Option(
            help="By which an audit without --stop-when is decided: that in force since "
            "2026-11-23, or the exact one for scenes that were seen under it."
        ),
    ] = "unconditional",
    details: Annotated[
        bool,
        typer.Option(
            "--details", help="Print every sentence of the record too, and what would change it."
        ),
    ] = False,
    set_: Annotated[list[str] | None, typer.Option("--set", help=SET)] = None,
    out: Annotated[
        Path | None, typer.Option(parser=path, help="Run folder; default runs/<question>-<code>.")
    ] = None,
    share: Share = None,
    workers: Annotated[
        int | None,
        typer.Option(
            help="Worker processes, 0 for this process alone; default one per core if that helps."
        ),
    ] = None,
    executor: Executor = "local",
    time_limit: TimeLimit = None,
    no_signals: Annotated[
        bool,
        typer.Option(
            "--no-signals",
            help="Do not fly the report's first scenes once more to plot their signals.",
        ),
    ] = False,
    as_json: Json = False,
) -> int:
    """Audit a repair against a baseline under correct inputs, under the fault at each module
    alone, and under the shared fault.

    `faultpath audit --study FILE` carries out what `faultpath plan` wrote instead."""
    every_seed, options = numbers(seeds, "--seeds"), settings(set_ or [])
    # What builds a system may load for seconds; until then this is all that there is to see.
    arms = f"{one_line(repair)} with {one_line(baseline)}"
    typer.echo(f"Building {one_line(system)}, to compare {arms}.", err=as_json)

    from faultpath.door.display import Display, SafeConsole
    from faultpath.door.sizes import audits

    console = SafeConsole(stderr=as_json)
    runs = audits(
        system,
        baseline=baseline,
        repair=repair,
        fault=fault,
        library=library,
        scenes=scenes,
        seeds=every_seed,
        primary=primary,
        generalise=generalise,
        metric=metric,
        thresholds=() if thresholds is None else sizes(thresholds, "--thresholds"),
        stop_when=stop_when,
        margin_pp=margin,
        rule=rule,
        options=options,
        folder=out,
        share=share,
        workers=workers,
        executor=executor,
        time_limit_s=time_limit,
        signals=not no_signals,
        progress=Display(console, ("faultpath", *sys.argv[1:])),
    )

    if as_json:
        tell_json(runs)
    if len(runs) > 1:
        if details:
            tell(console, runs, details)
        return _tell_sweep(console, runs, out)
    return tell(console, runs, details)


def _tell_sweep(console: "SafeConsole", runs: "Sequence[Run]", out: Path | None) -> int:
    """Print what was decided at each size, side by side, and write it as one page too."""
    from faultpath.door.comparing import compare
    from faultpath.door.sizes import sweep_page
    from faultpath.report.comparison.page import shown

    compared = compare(runs)
    page = compared.report(sweep_page(runs, out))
    console.print(shown(compared.runs))
    console.print(f"Page: {page}", markup=False, soft_wrap=True)
    return FAILED_TRIALS if any(run.failed for run in runs) else 0


def tell(console: "SafeConsole", runs: "Sequence[Run]", details: bool = False) -> int:
    """Print what was decided in each run, and return the status of the command."""
    from faultpath.report.terminal import decision

    for run in runs:
        if len(runs) > 1:
            console.print(f"\nFault {run.record.question.fault}", markup=False)
        console.print(decision(run.record, details))
        console.print(f"Report: {run.folder / 'report.html'}", markup=False, soft_wrap=True)
    return FAILED_TRIALS if any(run.failed for run in runs) else 0


def tell_json(runs: "Sequence[Run]") -> None:
    """Print folder and record of each run, of several sizes with what stands over all of them."""
    from faultpath.door.comparing import compare, folder_and_record

    several = len(runs) > 1
    told = compare(runs).as_json()["runs"] if several else [folder_and_record(runs[0].folder)]
    typer.echo(json.dumps(told, indent=1))
