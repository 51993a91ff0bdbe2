"""How every arm ended, path by path."""

from collections.abc import Sequence
from statistics import median

from faultpath.record.family import CORRECT
from faultpath.record.model import Cell, Path
from faultpath.record.question import Question
from faultpath.trials.outcome import Status
from faultpath.trials.table import OutcomeTable


def arms_shown(question: Question, paths: Sequence[Path], table: OutcomeTable) -> tuple[Cell, ...]:
    """Return the trials of both arms on every path."""
    return tuple(
        _cell(table, variant, path.name)
        for path in paths
        for variant in (question.baseline, question.repair)
    )


def untested_paths(paths: Sequence[Path], cells: Sequence[Cell]) -> tuple[str, ...]:
    """Return the paths on which the fault changed nothing in any trial."""
    acted = {cell.path for cell in cells if cell.altered_trials}
    return tuple(path.name for path in paths if path.name != CORRECT and path.name not in acted)


def _cell(table: OutcomeTable, variant: str, path: str) -> Cell:
    rows = [row for seed in table.seeds(variant, path) for row in table.arm(variant, path, seed)]
    outcomes = [row.outcome for row in rows]
    count = {status: sum(o.status is status for o in outcomes) for status in Status}
    ran = len(outcomes) - count[Status.FAILED]
    times = [o.time_s for o in outcomes if o.status is Status.SUCCESS]
    return Cell(
        variant=variant,
        path=path,
        trials=len(outcomes),
        success=count[Status.SUCCESS],
        crash=count[Status.CRASH],
        timeout=count[Status.TIMEOUT],
        failed=count[Status.FAILED],
        success_percent=100 * count[Status.SUCCESS] / ran if ran else 0.0,
        median_time_s=median(times) if times else None,
        struck_trials=sum(o.struck_steps > 0 for o in outcomes),
        altered_trials=sum(o.altered_steps > 0 for o in outcomes),
    )
