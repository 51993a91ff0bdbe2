"""`faultpath audit`: run the arms of one question, decide, report."""

import hashlib
import re
import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

from faultpath.cli.options import SET, TimeLimit, numbers, path, settings, worker_count

FAILED_TRIALS = 1
LONGEST_NAME = 180
"""Of a run folder; file systems take 255 bytes."""


def command(
    system: Annotated[
        str,
        typer.Argument(
            help="`quadrotor`, `module:attribute` or `file.py:attribute`; --help after it shows "
            "its own options too."
        ),
    ],
    baseline: Annotated[str, typer.Option(help="Variant to compare with.")],
    repair: Annotated[str, typer.Option(help="Variant that is meant to help.")],
    fault: Annotated[
        str,
        typer.Option(
            help="`calibration=+0.1`, or as in `mass:scale=1.1`, `wind:delay=5@predictor,onset=20`."
        ),
    ],
    library: Annotated[str, typer.Option(help="Library of scenes.")] = "held-out",
    scenes: Annotated[int | None, typer.Option(help="Run only the first so many scenes.")] = None,
    seeds: Annotated[
        str, typer.Option(help="Seeds of the noise, and of trained models where there are any.")
    ] = "0",
    primary: Annotated[
        str | None,
        typer.Option(help="Path of the primary contrast, a module or shared (default)."),
    ] = None,
    generalise: Annotated[
        Literal["scenes", "models"],
        typer.Option(help="To new scenes, or to newly trained models too (several seeds)."),
    ] = "scenes",
    set_: Annotated[list[str] | None, typer.Option("--set", help=SET)] = None,
    out: Annotated[
        Path | None, typer.Option(parser=path, help="Run folder; default runs/<question>-<code>.")
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            help="Worker processes, 0 for none beside this one; default one a core, if that helps."
        ),
    ] = None,
    time_limit: TimeLimit = None,
) -> int:
    """Audit a repair against a baseline under correct inputs, under the fault at each module
    alone, and under the shared fault."""
    from faultpath.audit import plan_audit
    from faultpath.faults import parse_fault
    from faultpath.patience import patience
    from faultpath.trials import SystemSpec, library_of, load_system

    options = settings(set_ or [])
    spec = SystemSpec(name=system, options=options)
    with patience(system, time_limit):
        built = load_system(spec)
        scenes_from = library_of(built, library)
    audit = plan_audit(
        built,
        spec,
        baseline=baseline,
        repair=repair,
        fault=parse_fault(fault, built.interface, built.fault_presets, built.control_dt_s),
        fault_text=fault,
        library=scenes_from,
        scenes=scenes,
        seeds=numbers(seeds, "--seeds"),
        primary=primary,
        generalise=generalise,
    )

    # Pages and workers: no mistake so far waits for them.
    from faultpath.cli.run import run_audit
    from faultpath.store.earlier import keyed
    from faultpath.trials.state import system_code

    name = _name(audit.study.name, fault, library, scenes, seeds, options)
    folder, other = (out, "") if out else keyed(Path("runs"), name, system_code(built, spec).state)
    count = worker_count(built, workers)

    failed = run_audit(built, audit, folder, count, ("faultpath", *sys.argv[1:]), other, time_limit)
    return FAILED_TRIALS if failed else 0


def _name(
    study: str,
    fault: str,
    library: str,
    scenes: int | None,
    seeds: str,
    options: dict[str, str],
) -> str:
    """Name the run folder after everything that makes it another study."""
    parts = [study, fault, Path(library).stem, *(f"{k}-{v}" for k, v in sorted(options.items()))]
    if scenes is not None:
        parts.append(f"{scenes}-scenes")
    if seeds != "0":
        parts.append(f"seeds-{seeds}")
    name = re.sub(r"[^A-Za-z0-9.+=,_-]+", "_", "-".join(parts)).strip("._")
    if len(name) > LONGEST_NAME:
        name = f"{name[:LONGEST_NAME]}-{hashlib.sha256(name.encode()).hexdigest()[:12]}"
    return name
