"""Report files on disk."""

from collections.abc import Callable
from pathlib import Path

from faultpath.report.html import report_page
from faultpath.report.inputs import ReportInput
from faultpath.report.tables import latex_table, markdown_table
from faultpath.store import make_folder, write_text


def write_report(input: ReportInput, folder: Path) -> list[Path]:
    """Write `report.html`, `table.tex` and `table.md` into `folder` and return their paths.

    Each file appears whole or not at all. Raises `UserError` where the folder cannot be written.
    """
    makers: dict[str, Callable[[], str]] = {
        "report.html": lambda: report_page(input),
        "table.tex": lambda: latex_table(input.record),
        "table.md": lambda: markdown_table(input.record),
    }
    make_folder(folder)
    for name, make in makers.items():
        write_text(folder / name, make(), folder)
    return [folder / name for name in makers]
