"""Tables of the studies: what the shipped run, whose tables are all compared, does not show."""

import pytest
from faultpath_paper.cells import Cell
from faultpath_paper.pages import table_3, table_4, table_6
from faultpath_paper.results import Results
from faultpath_quadrotor.training import trajectories
from toy_runs import SCENES, Ends, calibrated, measured, page, run, tables, won

from faultpath.report.tables import markdown_block
from faultpath.system import Status


def below(wins) -> Ends:
    """Let a cell win the scenes below a number that follows from it and the seed."""
    return lambda cell, seed, scene: Status.SUCCESS if scene < wins(cell, seed) else Status.CRASH


def of_all_kinds(cell: Cell, seed: int, scene: int) -> Status:
    """Let 12 scenes be won, two crash and the others time out; one of DKI's fails."""
    if cell.variant == "dki" and scene == SCENES - 1:
        return Status.FAILED
    return Status.SUCCESS if scene < 12 else Status.CRASH if scene < 14 else Status.TIMEOUT


def common(cell: Cell, seed: int, scene: int) -> Status:
    """Let a scene more be won with each seed; DKI loses one that the others win."""
    won = scene < 12 + seed and (cell.variant, scene) != ("dki", 3)
    return Status.SUCCESS if won else Status.CRASH


def reversing(cell: Cell) -> int:
    """GRU falls under the isolated error and recovers under the shared one; GRU+DCC stays."""
    alone = any("reconstruction" in fault for fault in cell.faults)
    return 10 if cell.variant == "gru+dcc" else 4 if alone else 16


def with_medians(seeds: tuple[int, ...]) -> Results:
    """Return a run whose errors are one more than their seed."""
    asked = [m for m in table_6.PAGE.measurements if m.seed in seeds]
    return run(won(calibrated), evidence=measured(asked, lambda m: 1.0 + m.seed))


CASES = {
    "trials of all kinds": ("table-1", "table-1", lambda: run(of_all_kinds)),
    "common successes": ("table-1", "table-1b", lambda: run(common)),
    "winds that were not met": (
        *("table-3", "table-3b"),
        lambda: run(below(lambda _, seed: 75 + seed), page("table-3").cells, scenes=range(60, 80)),
    ),
    "a reversal": ("table-4", "table-4", lambda: run(won(reversing))),
    "a reversal, when it pays": ("table-5", "table-5", lambda: run(won(reversing))),
    "a reversal, compensated": ("table-6", "table-6b", lambda: run(won(reversing))),
    "an observer of one run": (
        *("table-4", "table-4"),
        lambda: run(below(lambda cell, seed: 10 + seed * (cell.variant == "gru"))),
    ),
    "medians of three seeds": ("table-6", "table-6a", lambda: with_medians((0, 1, 2))),
    "medians of one seed": ("table-6", "table-6a", lambda: with_medians((0,))),
}


@pytest.mark.parametrize("name", CASES)
def test_a_table_is_what_was_approved(name: str, approved) -> None:
    of, table, results = CASES[name]
    approved(name, markdown_block(tables(page(of), results())[table]))


def test_the_observer_flies_once_and_scenes_of_training_have_their_wind() -> None:
    dob = table_4.cell("dob", "correct")
    assert (dob.fixed, dob.seeds) == (True, (0,))
    assert len(run(won(calibrated)).pairs(dob, dob).void) == 1
    assert table_3.UNMET.start == trajectories.SCENES
