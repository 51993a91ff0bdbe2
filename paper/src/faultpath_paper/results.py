"""Outcomes and measurements of the studies' runs, as tables, figures and claims read them."""

import math
from collections.abc import Callable, Collection
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any, Concatenate, ParamSpec

import numpy as np

from faultpath.core.errors import UserError
from faultpath.run.pairing import Pairs, pair
from faultpath.run.trials import Trials
from faultpath.stats.contrast import Contrast
from faultpath.stats.effects import success_rate
from faultpath.stats.estimate import Estimate
from faultpath.stats.resamples import Resamples
from faultpath.system import Outcome, Status
from faultpath_paper.cells import Cell
from faultpath_paper.detection import Difference, enough
from faultpath_paper.evidence.table import EvidenceTable, Measured, Measurement


class NotRun(Exception):
    """The run holds no trial of a cell, or no value of a measurement, that was asked for."""


class Undecidable(Exception):
    """The run holds everything that was asked for, and yet nothing that decides."""


@dataclass(frozen=True)
class Results:
    """A run of studies: its outcome table, and what was measured on recorded windows."""

    trials: Trials
    evidence: EvidenceTable
    library_hash: str
    """Names the bootstrap's stream, so that intervals do not depend on where they are made."""

    def seeds(self, cell: Cell) -> tuple[int, ...]:
        """Return the seeds of a cell that were run; `NotRun` without any."""
        run = [s for s in self.trials.seeds_of(cell.variant, cell.condition) if s in cell.seeds]
        if not run:
            raise NotRun(cell)
        return tuple(run)

    def common_seeds(self, *cells: Cell) -> tuple[int, ...]:
        """Return the seeds that several cells pair over; fixed ones pair with any.

        `NotRun` when there are none.
        """
        run = {cell: self.seeds(cell) for cell in cells}
        trained = [seeds for cell, seeds in run.items() if not cell.fixed] or list(run.values())
        common = tuple(seed for seed in trained[0] if all(seed in other for other in trained))
        if not common:
            raise NotRun(f"a seed that {cells[0]} and all it is compared with share")
        return common

    def has(self, cell: Cell) -> bool:
        """Return whether any trial of a cell was run."""
        return bool(self.trials.seeds_of(cell.variant, cell.condition))

    def pairs(
        self,
        first: Cell,
        second: Cell,
        *,
        scenes: Collection[int] | None = None,
        other_noise: bool = False,
    ) -> Pairs:
        """Pair two cells over their common seeds; `scenes` keeps some indices.

        `other_noise` pairs planners that differ in how they draw: their noise cannot agree. Raises
        `UserError` where two trials met different conditions: these systems are our own.
        """
        seeds = self.common_seeds(first, second)
        pairs = pair(self.trials, first.group, second.group, seeds, other_noise=other_noise)
        if pairs.unpaired:
            raise UserError(str(pairs.unpaired[0]))
        pairs = pairs.whole()
        if scenes is not None:
            pairs = pairs.only({scene.id for scene in pairs.scenes if scene.index in scenes})
        if not pairs.scenes:
            raise NotRun(f"a scene of {first} and {second} to compare")
        return pairs

    def rate(self, cell: Cell) -> Estimate:
        """Return the success of a cell in percent, mean over its seeds."""
        pairs = self.pairs(cell, cell)
        return success_rate(pairs.ended(Status.SUCCESS)[0], self.resamples(pairs)).estimate()

    def first(self, cell: Cell) -> list[Outcome]:
        """Return the outcomes of seed 0's trials, without failed ones; `NotRun` without any."""
        if 0 not in self.seeds(cell):
            raise NotRun(f"{cell}, seed 0")
        ends = self.trials.outcomes(cell.variant, cell.condition, 0)
        ended = [outcome for outcome in ends if not outcome.failed]
        if not ended:
            raise NotRun(f"a trial of {cell} that did not fail")
        return ended

    def measured(self, measurement: Measurement) -> Measured:
        """Return the values of a measurement; `NotRun` when it was not made."""
        if measurement not in self.evidence:
            raise NotRun(f"{measurement.quantity} of {measurement.subject}")
        return self.evidence[measurement]

    def resamples(self, pairs: Pairs) -> Resamples:
        """Return the scene resamples that every contrast over so many scenes shares."""
        return _drawn(self.library_hash, len(pairs.scenes))


@lru_cache(maxsize=16)
def _drawn(library_hash: str, n_scenes: int) -> Resamples:
    """Draw once: hundreds of contrasts are of as many scenes."""
    return Resamples.draw(library_hash, n_scenes)


Quantity = Callable[[Results], Contrast]
"""Computes a number from a run, for tables and claims; raises `NotRun` or `Undecidable`."""
P = ParamSpec("P")


def quantity(compute: Callable[Concatenate[Results, P], Contrast]) -> Callable[P, Quantity]:
    """Make a function of a run and of cells or measurements one of the latter, before any run."""

    def named(*args: P.args, **kwargs: P.kwargs) -> Quantity:
        return lambda results: compute(results, *args, **kwargs)

    return named


def decisive(contrast: Contrast, telling: float = math.inf) -> Difference:
    """Return a contrast without its interval where too few scenes give it.

    `telling` as in `Difference`.
    """
    shown = contrast if enough(contrast) else replace(contrast, draws=np.empty(0), scenes=None)
    values: dict[str, Any] = {field.name: getattr(shown, field.name) for field in fields(shown)}
    values["telling"] = telling
    return Difference(**values)
