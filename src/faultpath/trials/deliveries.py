"""What the taps did in every arm of a study, from their receipts."""

from collections.abc import Mapping
from typing import Self

from pydantic import BaseModel, ConfigDict

from faultpath.taps import TapCount, added
from faultpath.trials.arm import Study
from faultpath.trials.findings import unproven, unread
from faultpath.trials.table import OutcomeTable


class RowDeliveries(BaseModel):
    """The taps of one row of a study."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    variant: str
    path: str
    seed: int
    taps: tuple[TapCount, ...]
    """In the order of the interface; empty where every trial failed."""


class Deliveries(BaseModel):
    """The taps of a study, row by row; written as `deliveries.json`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: int = 1
    rows: tuple[RowDeliveries, ...] = ()
    findings: tuple[str, ...] = ()
    """What the run found that a reader of its results has to know, a sentence or two each."""

    @classmethod
    def of(
        cls,
        study: Study,
        arms: Mapping[str, tuple[TapCount, ...]],
        table: OutcomeTable,
        findings: tuple[str, ...] = (),
    ) -> Self:
        """Lay the counts, by arm key, out in the order of the study's rows.

        To `findings` it adds what counts and outcomes show: see `faultpath.trials.findings`.
        """
        rows = tuple(
            RowDeliveries(
                variant=row.variant,
                path=row.path,
                seed=row.seed,
                taps=arms.get(row.arm.key(), ()),
            )
            for row in study.rows
        )
        reads = [(row.variant, tap) for row in rows for tap in row.taps]
        return cls(rows=rows, findings=(*findings, *unread(reads), *unproven(table)))

    def at(self, variant: str, path: str) -> tuple[TapCount, ...]:
        """Return the taps of a variant on a path, all seeds together; `KeyError` without any."""
        rows = [row for row in self.rows if (row.variant, row.path) == (variant, path)]
        if not rows:
            raise KeyError((variant, path))
        return added(count for row in rows for count in row.taps)
