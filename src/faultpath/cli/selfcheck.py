"""`faultpath selfcheck`: does the installed code keep what it promises?"""

from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import path
from faultpath.cli.verbs import Verbs

BROKEN = 1

app = Verbs(help="Check that the installed code keeps what it promises.")


@app.callback()
def checks() -> None:
    """Keep `statistics` a command of its own."""


@app.command("statistics")
def statistics(
    quick: Annotated[
        bool, typer.Option("--quick", help="A small part, in seconds, with wide limits.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(parser=path, help="File to write the numbers to, as JSON.")
    ] = None,
    processes: Annotated[
        int | None, typer.Option(min=1, help="Processes; default one per core.")
    ] = None,
) -> int:
    """Simulate audits with a known truth: coverage of the intervals, power at the reported
    detectable difference, false announcements. Exits with 1 where a promise is not kept."""
    import os

    from faultpath.door.display import Display, Now, SafeConsole
    from faultpath.selfcheck import check_statistics, failures
    from faultpath.selfcheck.words import show
    from faultpath.store import check_writable, write_text

    if out is not None:
        check_writable(out)
    console = SafeConsole()
    with Display(console).progress("Simulating") as simulating:

        def note(done: int, total: int, seconds: float | None) -> None:
            simulating(Now(done, total, f"{done}/{total} settings", seconds))

        report = check_statistics(
            "quick" if quick else "full", processes or os.cpu_count() or 1, note
        )
    show(report, console)
    if out is not None:
        write_text(out, report.text())
    broken = failures(report)
    for line in broken:
        console.print(f"Not kept: {line}", markup=False, soft_wrap=True)
    if not broken:
        console.print("No promise is broken by more than three standard errors.")
    return BROKEN if broken else 0
