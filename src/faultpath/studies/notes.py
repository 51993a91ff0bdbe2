"""Notes below tables: what was flown and measured for them, and how to read their intervals."""

from collections.abc import Iterable
from contextlib import suppress

from faultpath.evidence import Measured, Measurement
from faultpath.record import wording
from faultpath.studies.cells import Cell
from faultpath.studies.results import NotRun, Results

INTERVALS = (
    "Intervals, 95 %, for these trained models and recorded executions: score intervals for "
    "success (Tango's; over seeds cluster-robust), percentile bootstrap of whole scenes for what "
    "has no bound. Bold: the interval excludes 0 and the paper's test rejects at 0.05 on the same "
    "side (exact McNemar for one seed, sign test on scene means for several), each by itself. "
    "Times, distances and errors are secondary: nothing is decided from them, and none is bold."
)
WINS = "Wins:losses: scenes in which only the first, or only the second, succeeded, seed by seed."
LEAST = (
    "Least detectable: the true difference that is detected at 0.05 with 80 % power; none: so few "
    "scenes detect no difference."
)
EVERY_NOISE = (
    "What is not trained anew meets the planner noise of every seed, so that it pairs with every "
    "trained seed; the paper pairs one run of it with each."
)
WINDOWS = "Errors: median over all windows, 20 control steps ahead."


def flown(results: Results, cells: Iterable[Cell]) -> str:
    """Return scenes and seeds that a run holds of cells, library by library."""
    held: dict[str, tuple[set[str], set[int]]] = {}
    for cell in cells:
        with suppress(NotRun):
            run = results.seeds(cell)
            library = cell.setting.library
            scenes, seeds = held.setdefault(library, (set(), set()))
            seeds.update(run)
            rows = results.outcomes.arm(cell.variant, cell.path, run[0])
            scenes.update(row.outcome.scene for row in rows)
    if not held:
        return "No trial of this table was run."
    parts = (
        f"{wording.counted(len(scenes), 'scene')} of the {library} library, "
        f"{wording.seeds(tuple(sorted(seeds)))}"
        for library, (scenes, seeds) in held.items()
    )
    return wording.sentence("; ".join(parts))


def recorded(results: Results, measurements: Iterable[Measurement]) -> str:
    """Return windows, scenes, library and seeds that a run holds of one recording."""
    found: dict[Measurement, Measured] = {}
    for measurement in measurements:
        with suppress(NotRun):
            found[measurement] = results.measured(measurement)
    if not found:
        return "No error of this table was measured."
    measurement, windows = next(iter(found.items()))
    library = measurement.recording.library
    scenes = wording.counted(len(set(windows.scenes)), "scene")
    seeds = wording.seeds(tuple(sorted({measurement.seed for measurement in found})))
    return f"{len(windows):,} windows of {scenes} of the {library} library, {seeds}."
