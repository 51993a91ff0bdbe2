"""A finished reproduction, as scripts and notebooks hold it."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, NoReturn

from faultpath.api.saved import read_provenance
from faultpath.core.errors import UserError
from faultpath.decisions import Reproduction, RunProvenance
from faultpath_quadrotor.paper.report.words import headline
from faultpath.trials.store.sealed import AGAIN, unseal
from faultpath_quadrotor.paper.run import RESULTS, read_results
from faultpath.decisions.tables import markdown


@dataclass(frozen=True, repr=False, eq=False)
class ReproductionRun:
    """A finished reproduction: what was found, and where its files are.

    A notebook shows the tables, with the paper's numbers beside our own.
    """

    kind: ClassVar[str] = "reproduction"
    folder: Path
    record: Reproduction
    """Tables, figures, and in `ledger` the claims of the paper with what became of each."""
    provenance: RunProvenance

    @property
    def headline(self) -> str:
        """How many claims are confirmed, in one sentence."""
        return f"{headline(self.record.ledger, self.record.profile)}."

    def report(self) -> NoReturn:
        """Raise `UserError`: the pages of a reproduction are written when it is carried out."""
        raise UserError(f"the pages of the reproduction in {self.folder} stand there already.")

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
    provenance = read_provenance(folder)
    unseal(folder, provenance.files, RESULTS)
    results, found = read_results(folder)
    rows = results.outcomes.rows
    if (found.trials, found.failed_trials) != (len(rows), sum(row.outcome.failed for row in rows)):
        raise UserError(
            f"the files of {folder} do not belong together (reproduction.json counts other trials "
            f"than outcomes.parquet holds): {AGAIN}."
        )
    return ReproductionRun(folder, found, provenance)
