"""All tables of a self-check, as a page and for the terminal."""

from collections.abc import Sequence

from rich.console import Console

from faultpath.selfcheck.audits import EQUAL
from faultpath.selfcheck.coverage import BREAK_EVEN, INTERVAL, MODELS
from faultpath.selfcheck.model import Report
from faultpath.selfcheck.sequential import ANY_LOOK
from faultpath.selfcheck.words import TABLES
from faultpath.tables import Table
from faultpath.tables.markdown import grid
from faultpath.tables.terminal import drawn


def tables(report: Report) -> list[Table]:
    """Return all tables of a report."""
    names = {section.name for section in report.sections}
    return [shown.table(report) for shown in TABLES if shown.section in names]


def page(report: Report, broken: Sequence[str]) -> str:
    """Return the page that documents a report."""
    minutes = report.seconds / 60
    kept = ["No promise below is broken by more than three standard errors."]
    if broken:
        heading = "Promises broken by more than three standard errors:"
        kept = [heading, "", *(f"- {sentence}" for sentence in broken)]
    lines = [
        "# What the statistics keep",
        "",
        f"Made by `faultpath selfcheck statistics --profile {report.profile}` in {minutes:.0f} "
        "minutes; the numbers are in [reference/statistics-check.json]"
        "(reference/statistics-check.json). Populations with a known truth are sampled, and the "
        "shipped code decides. Simulated rates have a standard error of "
        f"{_error(report, INTERVAL)} (interval), {_error(report, BREAK_EVEN)} (break-even), at "
        f"most {_error(report, EQUAL)} (audits), {_error(report, ANY_LOOK)} (sequential audits) "
        f"and {_error(report, MODELS)} (newly trained models); those of one seed are exact, but "
        "for break-even, audits and all that is sequential.",
        "",
        "What is promised, and how it is decided: [design/statistics.md](design/statistics.md).",
        "",
        *kept,
        "",
    ]
    for table in tables(report):
        lines += [f"## {table.title}", "", *table.notes, "", grid(table), ""]
    return "\n".join(lines).rstrip() + "\n"


def show(report: Report, console: Console) -> None:
    """Print every table with its note."""
    for table in tables(report):
        console.print()
        console.print(drawn(table))
        console.print(*table.notes, markup=False)


def _error(report: Report, name: str) -> str:
    runs = max(float(cell["runs"]) for cell in report.section(name).cells())
    return f"{(0.05 * 0.95 / runs) ** 0.5:.3f}".lstrip("0")
