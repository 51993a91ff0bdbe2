"""A reproduction from start to end, on a selection scene and two of its cells."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from faultpath_paper import flights
from faultpath_paper.answers import Reproduction
from faultpath_paper.cells import HELD_OUT, PAPER, QUICK, Cell, Profile, calibration
from faultpath_paper.entries import centimetres, success
from faultpath_paper.page import Page, TableRow, TableSpec
from faultpath_paper.pages import PAGES, table_1, table_2
from faultpath_paper.run import ChosenPages, chosen_pages, conclude, measure_all, read_results, save

from faultpath.api.display import Display
from faultpath.api.job import Job
from faultpath.core.errors import UserError
from faultpath.run.work.executor import Here

SILENT = Display(command=("faultpath", "reproduce"))
TINY = Profile("tiny", scenes=1, seeds=(0,))
NOMINAL = table_2.cell("wm-a", 0.0)
FAULTY = table_2.cell("wm-a", 0.1)
ERROR = table_2.error_under(0.1)


ROWS = tuple(TableRow("", (of,)) for of in (success(NOMINAL), success(FAULTY), centimetres(ERROR)))
ONE = Page("one", (TableSpec("one", "One", ("Success, %",), ROWS),))


@pytest.fixture(scope="module")
def short() -> Iterator[None]:
    """Flights of two seconds, long enough for a window."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("faultpath_quadrotor.plant.module.CONTROL_STEPS", 40)
        yield


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory, selection_held_out: None, short: None) -> Path:
    """A folder with the whole of page one."""
    folder = tmp_path_factory.mktemp("run")
    reproduction = ChosenPages((ONE,), TINY)
    job = Job(folder, Here(), SILENT)
    flown = flights.fly(reproduction.legs(), job, lambda now: None)
    evidence = measure_all(reproduction, folder, 0, lambda done, total: None)
    results = reproduction.results(flown.trials, evidence)
    save(folder, flown, results, conclude(reproduction, results))
    return folder


def test_what_was_saved_is_read_back(run: Path) -> None:
    results, found = read_results(run)
    assert found.trials == 2
    assert found.ledger.library == HELD_OUT
    assert {row.outcome.scene.split("/")[0] for row in results.trials} == {"selection"}
    assert len(results.pairs(NOMINAL, FAULTY).scenes) == 1
    assert len(results.measured(ERROR).values) > 0
    assert found == Reproduction.model_validate_json(found.model_dump_json())
    for cell in (NOMINAL, FAULTY):
        outcomes = results.trials.outcomes("wm-a", cell.condition, 0)
        assert {outcome.faulted_steps > 0 for outcome in outcomes} == {cell is FAULTY}


def test_a_profile_takes_its_seeds_and_joins_cells_that_share_trials() -> None:
    first, second = Cell(table_1.STILL, "wm-a"), Cell(table_1.STILL, "wm-a", seeds=(1, 2))
    (joined,) = PAPER.cells([first, second])
    assert joined.seeds == (0, 1, 2)
    assert QUICK.cells([second]) == ()
    fine = Cell(table_1.STILL, "wm-a", (calibration(0.05),), quick=False)
    assert QUICK.cells([fine]) == ()
    assert [cell.group for cell in PAPER.cells([fine])] == [fine.group]


def test_what_there_is_not_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"no page 'table-9'; choose from .*table-1"):
        chosen_pages(["table-9"], "quick")
    with pytest.raises(UserError, match="unknown profile 'huge'; choose one of quick, paper"):
        chosen_pages([], "huge")
    with pytest.raises(UserError, match="holds no finished reproduction"):
        read_results(tmp_path)


def test_all_pages_are_the_whole_paper() -> None:
    assert chosen_pages([], "paper").whole
    assert chosen_pages(["table-4"], "paper").place == "table-4"
    assert [page.name for page in PAGES] == [page.name for page in chosen_pages([], "quick").pages]
