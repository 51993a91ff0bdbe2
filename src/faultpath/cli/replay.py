"""`faultpath replay`: run trials of a finished run again."""

import json
from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import FOUND, Json, display
from faultpath.cli.options import path as as_path
from faultpath.core.errors import UserError


def replay(
    folder: Annotated[Path, typer.Argument(parser=as_path, help="Folder of a finished audit.")],
    scene: Annotated[
        list[str] | None,
        typer.Option(help="Scene by its id, several times for several; default those shown first."),
    ] = None,
    condition: Annotated[
        list[str] | None,
        typer.Option(help="Condition: correct, shared or a module's name; default all."),
    ] = None,
    signals: Annotated[
        bool,
        typer.Option("--signals", help="Keep the recorded signals, and make the report again."),
    ] = False,
    where: Annotated[
        bool,
        typer.Option(
            "--where",
            help="Say where baseline and repair part: when readings, commands and the state first "
            "differ. With several --condition, each version under the first and another, too.",
        ),
    ] = False,
    as_json: Json = False,
    code: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Code that the run names, to import it; several times for several.",
        ),
    ] = None,
    trust: Annotated[
        bool,
        typer.Option("--trust", help="Import all code that the file names; look at it first."),
    ] = False,
) -> int:
    """Run trials of a finished run again and compare them with the run, to the bit. It runs the
    system that the run names, which has to be installed, named with --code, or trusted. Exits with
    1 where one differs."""
    from faultpath.api.display import SafeConsole
    from faultpath.api.folders import RECORD, read_provenance, read_run
    from faultpath.api.replaying import chosen_scenes, keep_signals, replay, where_parted
    from faultpath.core.files.atomic import check_writable
    from faultpath.core.text import counted
    from faultpath.report.sentences.parting import compared, parted
    from faultpath.report.terminal import STYLES
    from faultpath.run.store.signals import SIGNALS

    if as_json and not where:
        raise UserError("--json prints what --where finds: give --where too.")
    if RECORD not in read_provenance(folder).files:
        raise UserError(f"{folder} holds no finished audit, and only its trials can be replayed.")
    if signals:
        check_writable(folder / SIGNALS)
    source = read_run(folder)
    scenes = chosen_scenes(source, scene or (), condition or ())
    console = SafeConsole(stderr=as_json)
    again = replay(source, scenes, condition or (), display().say, trust, code or ())
    replays = again.trials
    unlike = [trial for trial in replays if trial.deviation]
    for trial in unlike:
        at = trial.address
        place = f"{at.variant}, {at.condition}, seed {at.seed}, {at.scene}"
        console.print(f"{place}: {trial.deviation}.", markup=False, style=STYLES["bad"])
    message = (
        f"{counted(len(replays), 'trial')} in {counted(len(scenes), 'scene')} came out as in the "
        "run, to the bit."
    )
    if again.elsewhere:
        message = f"{message[:-1]}, on another processor: {again.elsewhere}."
    if unlike:
        why = f"since then these have changed: {'; '.join(again.changed)}"
        if not again.changed:
            why = "nothing that provenance.json names has changed, so the system does not repeat"
        message = (
            f"{len(unlike)} of {len(replays)} trials came out otherwise than in the run: {why}."
        )
    console.print(message, markup=False, style="" if unlike else STYLES["good"])
    partings = where_parted(source, replays, scenes, condition or ()) if where else []
    if as_json:
        typer.echo(json.dumps([of.model_dump(mode="json") for of in partings], indent=1))
    for of in partings if not as_json else ():
        sentence = f"{compared(of)}: {parted(source.record.facts, of)}"
        console.print(sentence, markup=False, highlight=False)
    if signals and len(unlike) < len(replays):
        for written in keep_signals(folder, source, replays):
            console.print(f"Written: {written}", markup=False, soft_wrap=True)
    return FOUND if unlike else 0
