"""Report files on disk."""

import os
import tempfile
from collections.abc import Callable
from pathlib import Path

from faultpath.errors import UserError
from faultpath.report.html import report_page
from faultpath.report.inputs import ReportInput
from faultpath.report.tables import latex_table, markdown_table


def write_report(input: ReportInput, folder: Path) -> list[Path]:
    """Write `report.html`, `table.tex` and `table.md` into `folder` and return their paths.

    Each file appears whole or not at all. Raises `UserError` where the folder cannot be written.
    """
    makers: dict[str, Callable[[], str]] = {
        "report.html": lambda: report_page(input),
        "table.tex": lambda: latex_table(input.record),
        "table.md": lambda: markdown_table(input.record),
    }
    written: list[Path] = []
    for name, make in makers.items():
        text = make()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            _replace(folder / name, text)
        except OSError as error:
            raise UserError(
                f"cannot write {name} into {folder} ({error.strerror}); "
                "choose a folder that you may write to and that has room."
            ) from error
        written.append(folder / name)
    return written


def _replace(path: Path, text: str) -> None:
    descriptor, name = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
    try:
        with os.fdopen(descriptor, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(
            name, 0o644
        )  # mkstemp keeps a file to its owner; a report is meant to be passed on
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
