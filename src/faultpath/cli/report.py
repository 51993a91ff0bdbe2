"""`faultpath report`: the pages of a run, audits side by side, or a list of runs."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import path
from faultpath.core.errors import UserError

_DEFAULT = Path("runs")


def command(
    folders: Annotated[
        list[Path] | None,
        typer.Argument(
            parser=path,
            help="One finished run, to write its pages again; several audits, to compare them; "
            "a folder of runs, by default runs/, to list them.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(parser=path, help="Write the comparison to this .html file too."),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the comparison or the list as JSON.")
    ] = False,
) -> None:
    """Write the pages of a finished run again, compare several audits, or list the runs in a
    folder; runs no code from any of them."""
    asked = folders or [_DEFAULT]
    if out is not None and len(asked) < 2:
        raise UserError("--out takes the page of a comparison: give two or more finished audits.")
    if len(asked) > 1:
        _compare(asked, out, as_json)
    elif (asked[0] / "provenance.json").exists():
        if as_json:
            raise UserError("--json prints a comparison or a list: record.json holds the record.")
        from faultpath.api.run import open_run

        for written in open_run(asked[0]).report():
            typer.echo(written)
    else:
        _list(asked[0], as_json)


def _compare(folders: Sequence[Path], out: Path | None, as_json: bool) -> None:
    from faultpath.api.comparing import compare

    compared = compare(folders)
    page = None if out is None else compared.report(out)
    if as_json:
        typer.echo(json.dumps(compared.as_json(), indent=1))
        return
    from faultpath.api.display import SafeConsole
    from faultpath.report.comparison.page import shown

    console = SafeConsole()
    console.print(shown(compared.runs))
    if page is not None:
        console.print(f"Page: {page}", markup=False, soft_wrap=True)


def _list(top: Path, as_json: bool) -> None:
    from dataclasses import asdict

    from faultpath.api.display import SafeConsole
    from faultpath.api.listing import runs

    found = runs(top)
    if as_json:
        typer.echo(json.dumps([asdict(each) for each in found], indent=1))
        return
    console = SafeConsole()
    for each in found:
        console.print(each.folder, markup=False, highlight=False, style="bold", soft_wrap=True)
        parts = (each.kind, each.state, each.finished, f"{each.trials} trials" * bool(each.trials))
        console.print(f"  {', '.join(filter(None, parts))}", markup=False, highlight=False)
        console.print(f"  {each.words}\n", markup=False, highlight=False, soft_wrap=True)
