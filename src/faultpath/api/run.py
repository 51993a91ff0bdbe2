"""A finished audit or map, as a program and a notebook use it."""

# pandas ships no types.
# pyright: reportMissingTypeStubs=false, reportUnknownMemberType=false

from dataclasses import dataclass
from importlib.metadata import entry_points
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import pyarrow as pa

from faultpath.api.saved import MAP, RECORD, parsed, read_provenance, read_run
from faultpath.core.errors import UserError
from faultpath.core.text import extra
from faultpath.decisions import DecisionRecord, RunProvenance
from faultpath.report.html import write_report
from faultpath.report.inputs import ReportInput
from faultpath.report.tables import markdown_table
from faultpath.trials import Status
from faultpath.trials.store.folder import OUTCOMES
from faultpath.trials.store.sealed import AGAIN, unseal

if TYPE_CHECKING:
    import pandas

    from faultpath.decisions.map.model import MapRecord

MAP_MADE_FROM = (MAP, OUTCOMES)
"""The files of a map's folder that its pages are made from, and checked against."""


@dataclass(frozen=True, repr=False, eq=False)
class Run:
    """A finished audit: what was decided, from which trials, and where its files are.

    A notebook shows it as the table of its effects, with the verdict below.
    """

    kind: ClassVar[str] = "audit"
    folder: Path
    _held: ReportInput
    _trials: pa.Table

    @property
    def record(self) -> DecisionRecord:
        """What was decided: `verdict.headline` in a sentence, `effects` in numbers."""
        return self._held.record

    @property
    def headline(self) -> str:
        """The verdict in one sentence."""
        return self.record.verdict.headline

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
        return f"<Run in {self.folder}: {self.headline}>"

    def _repr_markdown_(self) -> str:
        return markdown_table(self.record)


@dataclass(frozen=True, repr=False, eq=False)
class MapRun:
    """A finished reversal map: what was decided, and where its files are."""

    kind: ClassVar[str] = "map"
    folder: Path
    record: "MapRecord"
    """`headline` and `sentences` in words; `points`, `surface`, `flips`, `joint` in numbers."""
    provenance: RunProvenance

    @property
    def headline(self) -> str:
        """What was decided, in one sentence."""
        return self.record.headline

    def report(self, folder: str | PathLike[str] | None = None) -> list[Path]:
        """Write report.html, map.svg, correlation.svg and table.md, and return their paths."""
        from faultpath.report.map import write_map

        place = self.folder if folder is None else Path(folder)
        return write_map(self.record, self.provenance, place)

    def __repr__(self) -> str:
        """Return folder and headline."""
        return f"<MapRun in {self.folder}: {self.headline}>"

    def _repr_html_(self) -> str:
        return self.record._repr_html_()  # pyright: ignore[reportPrivateUsage]


def open_run(folder: str | PathLike[str]) -> "Run | MapRun | Any":
    """Open the folder of a finished audit or map, one's own or anybody's.

    It is taken for data: no code that it names is run, and every file is compared with its digest.
    What an installed distribution leaves behind is opened by it: an entry point in the group
    `faultpath.runs` names a file of such a folder, and what reads the folder. Raises `UserError`
    for a folder that holds none of them, or a damaged or changed one.
    """
    place = Path(folder)
    files = read_provenance(place).files
    if MAP in files:
        return read_map(place)
    if RECORD not in files:
        for point in entry_points(group="faultpath.runs"):
            if point.name in files:
                return point.load()(place)
    return Run(place, *read_run(place))


def read_map(folder: Path) -> MapRun:
    """Read a finished map, every file compared with its digest in `provenance.json`.

    `UserError` for a file that is missing, damaged or changed, and for files that do not belong
    together.
    """
    from faultpath.decisions.map.model import MapRecord

    provenance = read_provenance(folder)
    held = unseal(folder, provenance.files, MAP_MADE_FROM)
    record = parsed(held[MAP], folder / MAP, MapRecord)
    if (provenance.files[OUTCOMES], provenance.library_hash) != (
        provenance.outcomes_sha256,
        record.question.library_hash,
    ):
        raise UserError(f"the files of {folder} do not belong together: {AGAIN}.")
    return MapRun(folder, record, provenance)
