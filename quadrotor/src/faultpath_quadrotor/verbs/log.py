"""`faultpath log`: what a shared calibration error does to a recorded flight."""

from math import inf
from pathlib import Path
from typing import Annotated

import typer

from faultpath.plugin.commands import Json, UserError, number_in, path

EXAMPLE = "flight.ulg --columns px4 --mass 1.5"


def command(
    log: Annotated[
        Path, typer.Argument(parser=path, help="A .csv, .parquet or .ulg file, or a bag of ROS.")
    ],
    columns: Annotated[
        str, typer.Option(help="YAML file that says which columns hold what, or px4.")
    ],
    mass: Annotated[
        float | None, typer.Option(help="Mass of the vehicle, kg, in place of the map's.")
    ] = None,
    errors: Annotated[
        str, typer.Option(help="Calibration errors: mass (1 + e), thrust (1 - e).")
    ] = "0.1,-0.1",
    as_json: Json = False,
) -> None:
    """Compute from a recorded flight what a calibration error leaves, isolated and shared."""
    from faultpath_quadrotor.flightlog.compensation import compensation
    from faultpath_quadrotor.flightlog.flight import read_flight
    from faultpath_quadrotor.flightlog.reading import read_columns

    column_map = read_columns(columns)
    if mass is not None:
        if not 0.0 < mass < inf:
            raise UserError(f"--mass {mass:g} is not a mass: give kilograms above 0.")
        column_map = column_map.model_copy(update={"mass_kg": mass})
    result = compensation(read_flight(log, column_map), _sizes(errors))
    if as_json:
        typer.echo(result.model_dump_json(indent=2))
        return
    from faultpath.plugin.results import SafeConsole, drawn
    from faultpath_quadrotor.flightlog.words import CAVEAT, sentences, table

    console = SafeConsole()
    for sentence in (*sentences(result), CAVEAT):
        console.print(sentence, style="bold" if sentence != CAVEAT else "")
    errors_table = table(result)
    console.print("", drawn(errors_table, one_line=True), *errors_table.notes, sep="\n")


def _sizes(text: str) -> tuple[float, ...]:
    try:
        sizes = tuple(number_in(part) for part in text.split(","))
    except ValueError:
        raise UserError(
            f"--errors {text!r} is not a list of numbers, for example 0.1,-0.1."
        ) from None
    if len(set(sizes)) < len(sizes):
        raise UserError(f"--errors {text!r} names a size twice: give it once.")
    return sizes
