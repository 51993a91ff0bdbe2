"""`faultpath claims`: the paper's claims, confirmed or refuted by a run."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from faultpath.cli.options import FAILED_TRIALS, TimeLimit, path, refuse_unless, refuse_with

if TYPE_CHECKING:
    from faultpath.record import Ledger


def command(
    run: Annotated[
        Path | None,
        typer.Option(parser=path, help="Folder of a reproduction; default the shipped one."),
    ] = None,
    platform: Annotated[
        str | None,
        typer.Option(help="Shipped run to show, or platform to fly; default the quadrotor's."),
    ] = None,
    library: Annotated[
        Path | None,
        typer.Option(
            parser=path, help="Fly all studies on this library in place of the held-out one."
        ),
    ] = None,
    profile: Annotated[
        str | None, typer.Option(help="With --library: quick or paper (default).")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(parser=path, help="With --library: run folder.")
    ] = None,
    workers: Annotated[int | None, typer.Option(help="With --library: worker processes.")] = None,
    device: Annotated[str | None, typer.Option(help="With --library: cpu or cuda.")] = None,
    time_limit: TimeLimit = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the claims as JSON.")] = False,
) -> int:
    """Evaluate every claim of the paper from an outcome table, or on a library of your own."""
    from faultpath.errors import UserError

    if run is not None and library is not None:
        raise UserError(
            "--run reads a finished reproduction and --library makes a new one: give one of them."
        )
    if run is not None:
        refuse_with("--run", platform=platform)
    if library is None:
        refuse_unless(
            "--library",
            profile=profile,
            out=out,
            workers=workers,
            device=device,
            time_limit=time_limit,
        )
        return _show(run, platform, as_json)
    from faultpath.cli.reproduce import tell
    from faultpath.door.display import Display, SafeConsole
    from faultpath.door.reproduction import reproduce

    done = reproduce(
        profile=profile or "paper",
        library=str(library),
        folder=out,
        workers=workers,
        device=device,
        platform=platform,
        time_limit_s=time_limit,
        progress=Display(SafeConsole(stderr=as_json), ("faultpath", *sys.argv[1:])),
        name="claims",
    )
    if as_json:
        _print(done.record.ledger)
    else:
        tell(done, whole=True)
    return FAILED_TRIALS if done.record.failed_trials else 0


def _show(run: Path | None, platform: str | None, as_json: bool) -> int:
    """Show the answers of a run; one that did not come with faultpath is answered anew, so that
    they are those of the code that is here."""
    from faultpath.studies.shipped import shipped_ledger

    answers, profile = (shipped_ledger(platform), "paper") if run is None else _answered(run)
    if as_json:
        _print(answers)
        return 0
    from faultpath.door.display import SafeConsole
    from faultpath.report.reproduction.terminal import ledger_view

    SafeConsole().print(ledger_view(answers, profile))
    return 0


def _answered(run: Path) -> tuple["Ledger", str]:
    from faultpath.studies.claims import again
    from faultpath.studies.run import read_results

    results, found = read_results(run)
    return again(results, found.ledger), found.profile


def _print(answers: "Ledger") -> None:
    content = [claim.model_dump(mode="json") for claim in answers.claims]
    typer.echo(json.dumps(content, indent=2))
