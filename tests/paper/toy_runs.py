"""Runs of studies made up: every cell flown and every measurement made, with known results."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import product

import numpy as np
from faultpath_paper.cells import Cell, of_seed
from faultpath_paper.evidence.table import EvidenceTable, Measured, Measurement
from faultpath_paper.page import Page
from faultpath_paper.pages import PAGES
from faultpath_paper.results import Results
from outcomes import trial

from faultpath.report.tables import Entry, Table
from faultpath.run.pairing import Pairs
from faultpath.run.trials import Trial, Trials
from faultpath.system import Outcome, Status

SCENES = 20
Ends = Callable[[Cell, int, int], Status]
"""How the trial of a cell, seed and scene index ends."""

CELLS = tuple(dict.fromkeys(cell for page in PAGES for cell in page.cells))
MEASUREMENTS = tuple(dict.fromkeys(m for page in PAGES for m in page.measurements))


def won(wins: Callable[[Cell], int]) -> Ends:
    """Let a cell win its first so many scenes and crash in the others, whatever the seed."""
    return lambda cell, seed, scene: Status.SUCCESS if scene < wins(cell) else Status.CRASH


def trials(cells: Iterable[Cell], ends: Ends, scenes: Iterable[int] = range(SCENES)) -> Trials:
    """Return a table with each variant, condition and seed once."""
    variants = {(c.variant, c.condition, seed): c for c in cells for seed in c.seeds}
    return Trials.of(
        ended(variant, condition, i, ends(cell, seed, i), seed)
        for ((variant, condition, seed), cell), i in product(variants.items(), scenes)
    )


def ended(variant: str, condition: str, scene: int, status: Status, seed: int) -> Trial:
    """Return a trial that ends so; later scenes take longer."""
    if status is Status.FAILED:
        return trial(variant, condition, scene, status, seed=seed, metrics={})
    missed = 0.3 if status is Status.SUCCESS else 2.3
    metrics = {"terminal_distance_m": missed, "min_clearance_m": 0.25}
    time_s = 3.0 + 0.1 * scene
    return trial(variant, condition, scene, status, seed=seed, time_s=time_s, metrics=metrics)


def measured(
    measurements: Iterable[Measurement], value: Callable[[Measurement], float], scenes: int = SCENES
) -> EvidenceTable:
    """Return a table with eleven windows a scene, spread evenly around the value by 10 %."""
    spread = np.linspace(0.9, 1.1, 11)
    return EvidenceTable(
        {
            measurement: Measured(
                tuple(f"s{i:03d}" for i in range(scenes) for _ in spread),
                np.arange(scenes * len(spread)),
                np.tile(value(measurement) * spread, scenes),
            )
            for measurement in measurements
        }
    )


NOTHING = EvidenceTable({})


def run(
    ends: Ends,
    cells: Iterable[Cell] = CELLS,
    evidence: EvidenceTable = NOTHING,
    scenes: Iterable[int] = range(SCENES),
) -> Results:
    """Return what a run of some cells leaves."""
    return Results(trials(cells, ends, scenes), evidence, "toy")


EMPTY = Results(Trials.of(()), NOTHING, "toy")


@dataclass(frozen=True)
class Watched(Results):
    """Remembers what it is asked for."""

    cells: list[Cell] = field(default_factory=list[Cell])
    measurements: list[Measurement] = field(default_factory=list[Measurement])

    def pairs(self, first: Cell, second: Cell, **named: object) -> Pairs:
        self.cells.extend((first, second))
        # Keywords are passed on as they come, so their types are those of the method itself.
        return super().pairs(first, second, **named)

    def first(self, cell: Cell) -> list[Outcome]:
        self.cells.append(of_seed(cell))
        return super().first(cell)

    def measured(self, measurement: Measurement) -> Measured:
        self.measurements.append(measurement)
        return super().measured(measurement)


def tables(page: Page, results: Results) -> dict[str, Table]:
    return {part.name: part for part in page.build(results) if isinstance(part, Table)}


def page(name: str) -> Page:
    return next(page for page in PAGES if page.name == name)


def entries(table: Table) -> Iterator[Entry]:
    return (entry for each in table.lines for entry in each.entries)


def calibrated(cell: Cell) -> int:
    """Let repairs win 15 of 20 scenes, models without faults 14, and with faults 2."""
    return 15 if "dcc" in cell.variant else 2 if cell.faults else 14
