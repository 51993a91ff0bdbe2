"""`faultpath log`: what a shared calibration error does to a recorded flight."""

from pathlib import Path
from typing import Annotated

import typer

from faultpath.plugin.commands import Json, UserError, path, refuse_with

ERRORS = "0.1,-0.1"
EXAMPLE = "flight.ulg --columns px4 --mass 1.5"


def command(
    log: Annotated[
        Path, typer.Argument(parser=path, help="A .csv, .parquet or .ulg file, or a bag of ROS.")
    ],
    columns: Annotated[
        str | None, typer.Option(help="YAML file that says which columns hold what, or px4.")
    ] = None,
    propose: Annotated[
        bool, typer.Option("--propose", help="Write that file for a bag, by its topics' types.")
    ] = False,
    mass: Annotated[
        float | None, typer.Option(help="Mass of the vehicle, kg, in place of the map's.")
    ] = None,
    errors: Annotated[
        str | None,
        typer.Option(help="Calibration errors: mass (1 + e), thrust (1 - e).", show_default=ERRORS),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(parser=path, help="Folder for compensation.json.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Compute from a recorded flight what a calibration error leaves, isolated and shared."""
    from faultpath_quadrotor.flightlog.reading import HEAVIEST_KG, read_columns

    if mass is not None and not 1e-6 <= mass <= HEAVIEST_KG:
        raise UserError(f"--mass {mass:g} is not a mass: give kilograms above 0, at most 1e6.")
    if propose:
        refuse_with("--propose", errors=errors, out=out, json=as_json or None)
        _propose(log, Path(columns or "columns.yaml"), mass)
        return
    if columns is None:
        raise UserError("--columns is missing: name the map of the log, or for a bag --propose one")
    from faultpath_quadrotor.flightlog.compensation import compensation
    from faultpath_quadrotor.flightlog.flight import read_flight

    column_map = read_columns(columns)
    if mass is not None:
        column_map = column_map.model_copy(update={"mass_kg": mass})
    result = compensation(read_flight(log, column_map), _sizes(errors or ERRORS))

    from faultpath.plugin.data import check_output, make_folder, write_text
    from faultpath_quadrotor.flightlog.words import CAVEAT, sentences, table

    text = result.model_dump_json(indent=2) + "\n"
    if out is not None:
        make_folder(out)
        check_output(out / "compensation.json", b'"flown_s"')
        write_text(out / "compensation.json", text, out)
    if as_json:
        typer.echo(text, nl=False)
        return
    from faultpath.plugin.results import SafeConsole, drawn

    console = SafeConsole()
    for sentence in (*sentences(result), CAVEAT):
        console.print(sentence, style="bold" if sentence != CAVEAT else "")
    errors_table = table(result)
    console.print("", drawn(errors_table, one_line=True), *errors_table.notes, sep="\n")


def _propose(log: Path, to: Path, mass_kg: float | None) -> None:
    from faultpath.plugin.data import check_output, write_text
    from faultpath.plugin.results import SafeConsole
    from faultpath_quadrotor.flightlog.proposing import propose

    check_output(to)
    text = propose(log, mass_kg)
    write_text(to, text)
    comments = [line.removeprefix("# ") for line in text.splitlines() if line.startswith("#")]
    SafeConsole().print(*comments, f"Written: {to}", sep="\n", markup=False, soft_wrap=True)


def _sizes(text: str) -> tuple[float, ...]:
    try:
        sizes = tuple(float(part) for part in text.split(","))
    except ValueError:
        raise UserError(
            f"--errors {text!r} is not a list of numbers, for example 0.1,-0.1."
        ) from None
    if len(set(sizes)) < len(sizes):
        raise UserError(f"--errors {text!r} names a size twice: give it once.")
    return sizes
