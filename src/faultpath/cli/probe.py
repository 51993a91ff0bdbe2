"""`faultpath probe`: how far each variant's predictions move when an input is perturbed."""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from faultpath.cli.options import SET, names, numbers, path, settings

if TYPE_CHECKING:
    from rich.table import Table

    from faultpath.evidence import EvidenceTable, Measurer
    from faultpath.evidence.probe import Probe, ProbePlan, ProbeRow
    from faultpath.tables import Line


def command(
    system: Annotated[str, typer.Argument(help="`quadrotor`.")],
    variants: Annotated[
        str,
        typer.Option(help="Variants, the first compared with each of the others: wm-a,wm-a+dcc."),
    ],
    perturb: Annotated[
        list[str] | None,
        typer.Option(
            help="A fault, as in `audit`; repeat the option for more. `history_code:shuffle` "
            "swaps histories between windows. Default: calibration by its declared uncertainty."
        ),
    ] = None,
    library: Annotated[str, typer.Option(help="Library of scenes.")] = "selection",
    scenes: Annotated[int | None, typer.Option(help="Record only the first N scenes.")] = None,
    recorded_with: Annotated[
        str, typer.Option(help="Variant whose flights, under correct inputs, give the windows.")
    ] = "true-parameter",
    seeds: Annotated[str, typer.Option(help="Seeds of the trained models.")] = "0",
    set_: Annotated[list[str] | None, typer.Option("--set", help=SET)] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")] = False,
    out: Annotated[
        Path, typer.Option(parser=path, help="Folder that keeps recordings and measurements.")
    ] = Path("runs/probe"),
    workers: Annotated[
        int | None, typer.Option(help="Worker processes; default one per core.")
    ] = None,
) -> None:
    """Perturb an input on recorded windows, all else fixed: how far do predictions move?"""
    from faultpath.evidence import Recording
    from faultpath.evidence.probe import ProbePlan, expected_perturbations
    from faultpath.setup_limit import setup_limit
    from faultpath.trials import SystemSpec, load_measurer, load_system

    chosen = names(variants, "--variants")
    measure = load_measurer(system)
    options = settings(set_ or [])
    with setup_limit(system, None):
        built = load_system(SystemSpec(name=system, options=options))
    plan = ProbePlan(
        recording=Recording(library=library, variant=recorded_with, options=options),
        variants=chosen,
        perturbations=tuple(
            perturb or expected_perturbations(built.interface, built.fault_presets)
        ),
        seeds=numbers(seeds, "--seeds"),
    )
    count = os.cpu_count() or 1 if workers is None else workers
    table = _measure(measure, plan, scenes, out, count)
    probe = plan.conclude(table)

    from faultpath.store import write_text
    from faultpath.store.evidence import write_evidence

    write_evidence(out / "evidence.parquet", table)
    write_text(out / "probe.json", probe.model_dump_json(indent=2) + "\n", out)
    if as_json:
        typer.echo(probe.model_dump_json(indent=2))
    else:
        from faultpath.door.display import SafeConsole

        SafeConsole().print(_table(probe))


def _measure(
    measure: "Measurer", plan: "ProbePlan", scenes: int | None, folder: Path, workers: int
) -> "EvidenceTable":
    from faultpath.door.display import Display, SafeConsole
    from faultpath.work import Progress

    with Display(SafeConsole(stderr=True)).progress("Measuring") as show:

        def note(done: float, total: float) -> None:
            show(Progress(done, total, f"{done:.0f} of {total:.0f} flights"))

        return measure(plan.measurements(), scenes, folder, workers, note)


def _table(probe: "Probe") -> "Table":
    from faultpath.record import wording
    from faultpath.tables import Table as Figures
    from faultpath.tables.terminal import drawn

    title = (
        f"Median response after the horizon, {wording.counted(probe.windows, 'window')} of "
        f"{wording.counted(probe.scenes, 'scene')}, {wording.seeds(probe.seeds)}"
    )
    columns = ("variant", "response, cm", f"of {probe.rows[0].variant}'s")
    lines = tuple(map(_line, probe.rows))
    table = Figures(
        title=title, corner="perturbation", columns=columns, words=columns[:1], lines=lines
    )
    return drawn(table, one_line=True)


def _line(row: "ProbeRow") -> "Line":
    from math import exp

    from faultpath.record import wording
    from faultpath.tables import MISSING, line

    found, log = row.response_cm, row.log_ratio
    response = f"{wording.plain(found.value)} {wording.interval(found)}".rstrip()
    ratio = MISSING
    if log is not None and log.low is not None and log.high is not None:
        ratio = f"{exp(log.value):.2f} [{exp(log.low):.2f}, {exp(log.high):.2f}]"
    return line(row.perturbation, row.variant, response, ratio)
