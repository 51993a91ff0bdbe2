"""A finished map, as scripts hold it and the command line prints it."""

from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from faultpath.door.map_flying import MADE_FROM
from faultpath.door.saved import MAP, parsed, read_provenance
from faultpath.errors import UserError
from faultpath.plane.model import MapRecord
from faultpath.record import RunProvenance
from faultpath.report.plane import write_map
from faultpath.store.folder import OUTCOMES
from faultpath.store.sealed import AGAIN, unseal


@dataclass(frozen=True, repr=False, eq=False)
class MapRun:
    """A finished reversal map: what was decided, and where its files are."""

    folder: Path
    record: MapRecord
    """`headline` and `sentences` in words; `points`, `surface`, `flips`, `joint` in numbers."""
    provenance: RunProvenance

    def report(self, folder: str | PathLike[str] | None = None) -> list[Path]:
        """Write report.html, map.svg, correlation.svg and table.md, and return their paths."""
        place = self.folder if folder is None else Path(folder)
        return write_map(self.record, self.provenance, place)

    def __repr__(self) -> str:
        """Return folder and headline."""
        return f"<MapRun in {self.folder}: {self.record.headline}>"

    def _repr_html_(self) -> str:
        return self.record.as_html()


def read_map(folder: Path) -> MapRun:
    """Read a finished map, every file compared with its digest in `provenance.json`.

    `UserError` for a file that is missing, damaged or changed, and for files that do not belong
    together.
    """
    provenance = read_provenance(folder)
    held = unseal(folder, provenance.files, MADE_FROM)
    record = parsed(held[MAP], folder / MAP, MapRecord)
    if (provenance.files[OUTCOMES], provenance.library_hash) != (
        provenance.outcomes_sha256,
        record.question.library_hash,
    ):
        raise UserError(f"the files of {folder} do not belong together: {AGAIN}.")
    return MapRun(folder, record, provenance)
