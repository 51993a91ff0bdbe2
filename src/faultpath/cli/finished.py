"""`faultpath report` and `replay`: the verbs for finished runs."""

import json
from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import FOUND
from faultpath.cli.options import path as as_path
from faultpath.core.errors import UserError


def report(
    folders: Annotated[
        list[Path],
        typer.Argument(
            parser=as_path,
            help="One finished run, to write its pages again; several audits, to compare them.",
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(parser=as_path, help="Write the comparison to this .html file too."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the comparison as JSON.")] = False,
) -> None:
    """Write the pages of a finished run again, or compare several audits; runs no code from any
    of them."""
    if len(folders) == 1:
        if out is not None:
            raise UserError(
                "--out takes the page of a comparison: give two or more finished audits."
            )
        if as_json:
            raise UserError("--json prints a comparison: record.json holds the record of a run.")
        from faultpath.api.runs import open_run

        for written in open_run(folders[0]).report():
            typer.echo(written)
        return

    from faultpath.api.comparing import compare
    from faultpath.api.display import SafeConsole
    from faultpath.report.comparison import shown

    compared = compare(folders)
    page = None if out is None else compared.report(out)
    if as_json:
        typer.echo(json.dumps(compared.as_json(), indent=1))
        return
    console = SafeConsole()
    console.print(shown(compared.runs))
    if page is not None:
        console.print(f"Page: {page}", markup=False, soft_wrap=True)


def replay(
    folder: Annotated[Path, typer.Argument(parser=as_path, help="Folder of a finished audit.")],
    scene: Annotated[
        list[str] | None,
        typer.Option(help="Scene by its id, several times for several; default those shown first."),
    ] = None,
    path: Annotated[
        list[str] | None, typer.Option(help="Path of the fault, such as shared; default all.")
    ] = None,
    signals: Annotated[
        bool,
        typer.Option("--signals", help="Keep the recorded signals, and make the report again."),
    ] = False,
) -> int:
    """Run trials of a finished run again and compare them with the run, to the bit; it runs the
    system that the run names. Exits with 1 where one differs."""
    from faultpath.api.display import SafeConsole
    from faultpath.api.replaying import chosen_scenes, keep_signals, replay
    from faultpath.api.runs import RECORD, read_provenance, read_run
    from faultpath.decisions.tables.terminal import STYLES
    from faultpath.decisions.wording import counted

    if RECORD not in read_provenance(folder).files:
        raise UserError(f"{folder} holds no finished audit, and only its trials can be replayed.")
    held, _ = read_run(folder)
    scenes = chosen_scenes(held, scene or (), path or ())
    console = SafeConsole()
    found = replay(held, scenes, path or (), lambda said: console.print(said, markup=False))
    unlike = [each for each in found if each.differs]
    for each in unlike:
        at = each.address
        where = f"{at.variant}, {at.path}, seed {at.seed}, {at.scene}"
        console.print(f"{where}: {each.differs}.", markup=False, style=STYLES["bad"])
    said = (
        f"{counted(len(found), 'trial')} in {counted(len(scenes), 'scene')} came out as in the "
        "run, to the bit."
    )
    if unlike:
        said = (
            f"{len(unlike)} of {len(found)} trials came out otherwise than in the run: the code, "
            "the packages or the processor are not those that provenance.json names."
        )
    console.print(said, markup=False, style="" if unlike else STYLES["good"])
    if signals and len(unlike) < len(found):
        for written in keep_signals(folder, held, found):
            console.print(f"Written: {written}", markup=False, soft_wrap=True)
    return FOUND if unlike else 0
