"""`faultpath reproduce`: the paper's tables, figures and claims."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from faultpath.cli.options import FOUND, Json, display, path, refuse_with
from faultpath.run.question import Running

if TYPE_CHECKING:
    from faultpath_paper.reproduction import ReproductionRun

EXAMPLE = "table-4"


def command(
    pages: Annotated[
        list[str] | None, typer.Argument(help="`table-4`, `figure-3`, `text`, …; default all.")
    ] = None,
    profile: Annotated[
        str | None, typer.Option(help="quick (few scenes, one seed; default) or paper (its size).")
    ] = None,
    judge: Annotated[
        bool,
        typer.Option(
            "--judge",
            help="Run nothing: judge the claims by the run that ships, or by that in --out.",
        ),
    ] = False,
    out: Annotated[
        Path | None, typer.Option(parser=path, help="Run folder; default runs/<name>-<code>.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(help="Worker processes; default one per core, or per GPU.")
    ] = None,
    device: Annotated[str | None, typer.Option(help="cpu (default) or cuda.")] = None,
    executor: Annotated[
        str, typer.Option(help=Running.model_fields["executor"].description)
    ] = "local",
    time_limit: Annotated[
        float | None, typer.Option(help=Running.model_fields["time_limit_s"].description)
    ] = None,
    as_json: Json = False,
) -> int:
    """Run every study of the paper, or some of its pages, and compare the results with it."""
    if judge:
        refuse_with(
            "--judge",
            pages=pages or None,
            profile=profile,
            workers=workers,
            device=device,
            time_limit=time_limit,
        )
        _judge(out, as_json)
        return 0

    from faultpath_paper.reproduction import reproduce

    run = reproduce(
        pages or (),
        profile=profile or "quick",
        folder=out,
        workers=workers,
        executor=executor,
        device=device,
        time_limit_s=time_limit,
        progress=display(),
    )
    if as_json:
        record = run.record.model_dump(mode="json")
        typer.echo(json.dumps({"folder": str(run.folder), "record": record}, indent=1))
    else:
        show(run, whole=not pages)
    return FOUND if run.record.failed_trials else 0


def _judge(folder: Path | None, as_json: bool) -> None:
    """Show the claims of the shipped run, or those of `folder` as this code judges them."""
    if folder is None:
        from faultpath_paper.answers import shipped_ledger

        ledger, profile = shipped_ledger(), "paper"
    else:
        from faultpath_paper.claims import again
        from faultpath_paper.run import read_results

        results, record = read_results(folder)
        ledger, profile = again(results, record.ledger), record.profile
    if as_json:
        typer.echo(json.dumps([claim.model_dump(mode="json") for claim in ledger.claims], indent=2))
        return
    from faultpath.api.display import SafeConsole
    from faultpath_paper.report.terminal import ledger_view

    SafeConsole().print(ledger_view(ledger, profile))


def show(run: "ReproductionRun", whole: bool) -> None:
    """Print the ledger of the whole paper, or the tables of some pages."""
    from faultpath.api.display import SafeConsole
    from faultpath.report.terminal import drawn
    from faultpath_paper.report import words
    from faultpath_paper.report.terminal import ledger_view

    console = SafeConsole()
    profile = run.record.profile
    if whole:
        console.print(ledger_view(run.record.ledger, profile))
    elif profile == words.QUICK:
        console.print(f"{words.headline(run.record.ledger, profile)}. {words.VERDICTS}\n")
    for table in () if whole else run.record.tables:
        console.print(drawn(table))
    page = run.folder / "reproduction.html"
    console.print(f"Report: {page}", markup=False, soft_wrap=True)
