"""`faultpath interface`: who reads what."""

import json
from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import SET, path, settings


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
    from faultpath.report.interface_drawing import draw_interface
    from faultpath.report.terminal import interface_table
    from faultpath.store import write_text
    from faultpath.trials import SystemSpec, load_system

    places = [place.resolve() for place in (svg, yaml, schema) if place is not None]
    if len(set(places)) < len(places):
        raise UserError(
            "--svg, --yaml and --schema write three files: give each a path of its own."
        )
    built = load_system(SystemSpec(name=system, options=settings(set_ or [])))
    console = SafeConsole()
    console.print(interface_table(built.interface))
    for place, text in (
        (svg, lambda: draw_interface(built.interface)),
        (yaml, lambda: interface_yaml(built.interface)),
        (schema, lambda: json.dumps(Interface.model_json_schema(), indent=2) + "\n"),
    ):
        if place is not None:
            write_text(place, text())
            console.print(f"Written: {place}", markup=False, soft_wrap=True)
