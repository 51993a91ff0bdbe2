"""`faultpath selfcheck`: does the installed code keep what it promises?"""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from faultpath.cli.options import path
from faultpath.cli.verbs import Verbs

if TYPE_CHECKING:
    from faultpath.selfcheck import Report
    from faultpath.selfcheck.run import Progress

BROKEN = 1

app = Verbs(help="Check that the installed code keeps what it promises.")


Profile = Annotated[
    str,
    typer.Option(help="full; medium, in minutes; or quick, in seconds. Less has wider limits."),
]
Out = Annotated[
    Path | None, typer.Option(parser=path, help="File to write the numbers to, as JSON.")
]
Processes = Annotated[int | None, typer.Option(min=1, help="Processes; default one per core.")]


@app.command("statistics")
def statistics(profile: Profile = "full", out: Out = None, processes: Processes = None) -> int:
    """Simulate audits with a known truth: coverage of the intervals, power at the reported
    detectable difference, false announcements. Exits with 1 where a promise is not kept."""
    from faultpath.selfcheck import check_statistics

    return _checked(check_statistics, profile, out, processes)


@app.command("map")
def reversal_map(profile: Profile = "full", out: Out = None, processes: Processes = None) -> int:
    """Simulate reversal maps with a known truth: false announcements, coverage of the break-even
    correlation. Exits with 1 where a promise is not kept."""
    from faultpath.selfcheck import check_map

    return _checked(check_map, profile, out, processes)


def _checked(
    check: "Callable[[str, int, Progress], Report]",
    profile: str,
    out: Path | None,
    processes: int | None,
) -> int:
    import os

    from faultpath.door.display import Display, Now, SafeConsole
    from faultpath.selfcheck import failures
    from faultpath.selfcheck.pages import show
    from faultpath.store.outputs import NUMBERS, check_output, write_output

    if out is not None:
        check_output(out, NUMBERS)
    console = SafeConsole()
    with Display(console).progress("Simulating") as simulating:

        def note(done: int, total: int, seconds: float | None) -> None:
            simulating(Now(done, total, f"{done}/{total} settings", seconds))

        report = check(profile, processes or os.cpu_count() or 1, note)
    show(report, console)
    if out is not None:
        write_output(out, report.text(), NUMBERS)
    broken = failures(report)
    for line in broken:
        console.print(f"Not kept: {line}", markup=False, soft_wrap=True)
    if not broken:
        console.print("No promise is broken by more than three standard errors.")
    return BROKEN if broken else 0
