"""`faultpath replay`: fly trials of a finished run again, to check or to record signals."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from faultpath.cli.options import path as as_path
from faultpath.core.errors import UserError

if TYPE_CHECKING:
    from faultpath.api.display import SafeConsole
    from faultpath.report.inputs import ReportInput

DIFFERS = 1


def command(
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
    """Fly trials of a finished run again and compare them with the run, to the bit; it runs the
    system that the run names. Exits with 1 where one differs."""
    if not (folder / "provenance.json").exists():
        raise UserError(f"{folder} holds no provenance.json: give the folder of a finished run.")

    from faultpath.api.display import SafeConsole
    from faultpath.api.replaying import chosen_scenes
    from faultpath.api.saved import RECORD, read_provenance, read_run

    if RECORD not in read_provenance(folder).files:
        raise UserError(f"{folder} holds no finished audit, and only its trials can be replayed.")
    held, _ = read_run(folder)
    scenes = chosen_scenes(held, scene or (), path or ())
    console = SafeConsole()
    return fly_again(console, folder, held, scenes, path or (), signals)


def fly_again(
    console: "SafeConsole",
    folder: Path,
    held: "ReportInput",
    scenes: Sequence[str],
    paths: Sequence[str],
    signals: bool,
) -> int:
    """Fly trials of a run again, say how they came out, and return the status of the command.

    With `signals` what was heard is kept in the run's folder.
    """
    from faultpath.api.replaying import keep_signals, replay
    from faultpath.decisions.tables.terminal import STYLES
    from faultpath.decisions.wording import counted

    found = replay(held, scenes, paths, lambda said: console.print(said, markup=False))
    unlike = [each for each in found if each.differs]
    for each in unlike:
        at = each.address
        where = f"{at.variant}, {at.path}, seed {at.seed}, {at.scene}"
        console.print(f"{where}: {each.differs}.", markup=False, style=STYLES["bad"])
    if unlike:
        console.print(
            f"{len(unlike)} of {len(found)} trials came out otherwise than in the run: the code, "
            "the packages or the processor are not those that provenance.json names.",
            markup=False,
        )
    else:
        console.print(
            f"{counted(len(found), 'trial')} in {counted(len(scenes), 'scene')} came out as in the "
            "run, to the bit.",
            markup=False,
            style=STYLES["good"],
        )
    if signals and len(unlike) < len(found):
        for written in keep_signals(folder, held, found):
            console.print(f"Written: {written}", markup=False, soft_wrap=True)
    return DIFFERS if unlike else 0
