"""A finished reproduction, as scripts and notebooks hold it."""

from dataclasses import dataclass
from pathlib import Path

from faultpath.door.saved import read_provenance
from faultpath.errors import UserError
from faultpath.record import Reproduction
from faultpath.store.sealed import AGAIN, unseal
from faultpath.studies.run import RESULTS, read_results
from faultpath.tables import markdown


@dataclass(frozen=True, repr=False, eq=False)
class ReproductionRun:
    """A finished reproduction: what was found, and where its files are.

    A notebook shows the tables, with the paper's numbers beside our own.
    """

    folder: Path
    record: Reproduction
    """Tables, figures, and in `ledger` the claims of the paper with what became of each."""

    def __repr__(self) -> str:
        """Return folder and size."""
        return f"<ReproductionRun in {self.folder}: {self.record.trials} trials>"

    def _repr_markdown_(self) -> str:
        return "\n\n".join(map(markdown.block, self.record.tables))


def read_reproduction(folder: Path) -> ReproductionRun:
    """Read a finished reproduction, every file compared with its digest in `provenance.json`.

    `UserError` for a file that is missing, damaged or changed, and for files that do not belong
    together.
    """
    unseal(folder, read_provenance(folder).files, RESULTS)
    results, found = read_results(folder)
    rows = results.outcomes.rows
    if (found.trials, found.failed_trials) != (len(rows), sum(row.outcome.failed for row in rows)):
        raise UserError(
            f"the files of {folder} do not belong together (reproduction.json counts other trials "
            f"than outcomes.parquet holds): {AGAIN}."
        )
    return ReproductionRun(folder, found)
