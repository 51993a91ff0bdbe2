"""`faultpath compare`: finished audits side by side."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from faultpath.cli.audit import folder_and_record, over_sizes
from faultpath.cli.options import path

if TYPE_CHECKING:
    from faultpath.door.comparing import Comparison


def command(
    runs: Annotated[
        list[Path], typer.Argument(parser=path, help="Folders of two or more finished audits.")
    ],
    out: Annotated[
        Path | None, typer.Option(parser=path, help="Write a page too, to this .html file.")
    ] = None,
    as_json: Annotated[
        bool,
        typer.Option("--json", help="Print what is said, what differs and each record as JSON."),
    ] = False,
) -> None:
    """Set finished audits side by side: effects path by path, what differs between the runs, and
    where they are decided in opposite directions."""
    from faultpath.door.comparing import compare

    compared = compare(runs)
    page = None if out is None else compared.report(out)
    if as_json:
        typer.echo(json.dumps(_told(compared), indent=1))
        return

    from faultpath.door.display import SafeConsole
    from faultpath.report.comparison.page import shown

    console = SafeConsole()
    console.print(shown(compared.runs))
    if page is not None:
        console.print(f"Page: {page}", markup=False, soft_wrap=True)


def _told(compared: "Comparison") -> dict[str, object]:
    from faultpath.report.comparison import facts, words

    runs = compared.runs
    return {
        "headline": compared.headline,
        "sentences": words.sentences(runs),
        "differs": {fact.title: fact.values for fact in facts.differing(runs)},
        "runs": [folder_and_record(Path(run.folder)) | over_sizes(run) for run in runs],
    }
