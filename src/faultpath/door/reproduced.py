"""A finished reproduction, as scripts and notebooks hold it."""

from dataclasses import dataclass
from pathlib import Path

from faultpath.record import Reproduction


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
        from faultpath.tables import markdown

        return "\n\n".join(map(markdown.block, self.record.tables))
