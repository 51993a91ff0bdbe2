"""A finished audit, as a program and a notebook use it."""

# pandas ships no types.
# pyright: reportMissingTypeStubs=false, reportUnknownMemberType=false

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import pyarrow as pa

from faultpath.door.saved import MAP, RECORD, read_provenance, read_run
from faultpath.errors import UserError
from faultpath.record import DecisionRecord, RunProvenance
from faultpath.report.html import notebook_view, write_report
from faultpath.report.inputs import ReportInput
from faultpath.text import extra
from faultpath.trials import Status

if TYPE_CHECKING:
    import pandas

    from faultpath.door.mapped import MapRun
    from faultpath.door.reproduced import ReproductionRun


@dataclass(frozen=True, repr=False, eq=False)
class Run:
    """A finished audit: what was decided, from which trials, and where its files are.

    A notebook shows it as verdict, effects and table.
    """

    folder: Path
    _held: ReportInput
    _trials: pa.Table

    @property
    def record(self) -> DecisionRecord:
        """What was decided: `verdict.headline` in a sentence, `effects` in numbers."""
        return self._held.record

    @property
    def provenance(self) -> RunProvenance:
        """What ran, on what, with which code, packages and options."""
        return self._held.provenance

    @property
    def failed(self) -> int:
        """Number of trials in which the program raised an error; each voids its pair."""
        return self.table().column("status").to_pylist().count(Status.FAILED.value)

    def table(self) -> pa.Table:
        """Return the trials as an Arrow table, one row each: variant, path, seed, scene, status,
        time_s, the system's metrics (null where a trial has none), and what the taps did."""
        return self._trials

    def trials(self) -> "pandas.DataFrame":
        """Return the trials as a pandas DataFrame, with the columns of `table`.

        `UserError` where pandas is not installed.
        """
        try:
            return self.table().to_pandas()
        except ModuleNotFoundError:
            raise UserError(
                f"a DataFrame needs pandas, not installed here: {extra('pandas')}, "
                "or take the same as an Arrow table from table()."
            ) from None

    def report(self, folder: str | PathLike[str] | None = None) -> list[Path]:
        """Write report.html, table.tex and table.md, and return their paths.

        They go into `folder`, by default that of the run. `UserError` where it cannot be written.
        """
        return write_report(self._held, self.folder if folder is None else Path(folder))

    def __repr__(self) -> str:
        """Return folder and headline."""
        return f"<Run in {self.folder}: {self.record.verdict.headline}>"

    def _repr_html_(self) -> str:
        return notebook_view(self.record)


def open_run(folder: str | PathLike[str]) -> "Run | MapRun | ReproductionRun":
    """Open the folder of a finished audit, map or reproduction, one's own or anybody's.

    It is taken for data: no code that it names is run, and every file is compared with its digest.
    Raises `UserError` for a folder that holds neither, or a damaged or changed one.
    """
    place = Path(folder)
    files = read_provenance(place).files
    if MAP in files:
        from faultpath.door.mapped import read_map

        return read_map(place)
    if RECORD in files or not (place / "reproduction.json").exists():
        return Run(place, *read_run(place))
    from faultpath.door.reproduced import read_reproduction

    return read_reproduction(place)
