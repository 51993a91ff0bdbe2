"""`faultpath interface`: who reads what."""

import json
from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import SET, path, settings

_QUADROTOR = "quadrotor"


def command(
    system: Annotated[str, typer.Argument(help="`quadrotor`, or `file.py:attribute`.")],
    svg: Annotated[
        Path | None, typer.Option(parser=path, help="Draw it into this SVG file.")
    ] = None,
    yaml: Annotated[
        Path | None, typer.Option(parser=path, help="Write it into this YAML file.")
    ] = None,
    schema: Annotated[
        Path | None, typer.Option(parser=path, help="Write the JSON Schema of interface files.")
    ] = None,
    set_: Annotated[list[str] | None, typer.Option("--set", help=SET)] = None,
) -> None:
    """Print a system's information interface, and draw it."""
    from faultpath.door.display import SafeConsole
    from faultpath.errors import UserError
    from faultpath.interface import Interface, interface_yaml
    from faultpath.patience import patience
    from faultpath.report.terminal import interface_table
    from faultpath.store.outputs import DRAWING, INTERFACE, SCHEMA, check_output, write_output
    from faultpath.trials import SystemSpec, load_system

    asked = ((svg, DRAWING), (yaml, INTERFACE), (schema, SCHEMA))
    places = [place.resolve() for place in (svg, yaml, schema) if place is not None]
    if len(set(places)) < len(places):
        raise UserError(
            "--svg, --yaml and --schema write three files: give each a path of its own."
        )
    for place, kind in asked:
        if place is not None:
            check_output(place, kind)
    options = settings(set_ or [])
    if system == _QUADROTOR and not options and not places:
        from faultpath.quadrotor.interface import quadrotor_interface

        found = quadrotor_interface()  # its table needs no torch, which takes seconds to load
    else:
        with patience(system, None):
            found = load_system(SystemSpec(name=system, options=options)).interface
    console = SafeConsole()
    console.print(interface_table(found))
    if not places:
        return

    from faultpath.report.interface_drawing import draw_interface

    for (place, kind), text in zip(
        asked,
        (
            lambda: draw_interface(found),
            lambda: interface_yaml(found),
            lambda: json.dumps(Interface.model_json_schema(), indent=2) + "\n",
        ),
        strict=True,
    ):
        if place is not None:
            write_output(place, text(), kind)
            console.print(f"Written: {place}", markup=False, soft_wrap=True)
