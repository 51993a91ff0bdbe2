"""A reproduction from start to end, on two selection scenes and two of its cells."""

from pathlib import Path

import pytest

from faultpath.errors import UserError
from faultpath.evidence import EvidenceTable
from faultpath.record import Reproduction
from faultpath.studies import flights, stand_in
from faultpath.studies.cells import HELD_OUT, PAPER, QUICK, SELECTION, Cell, Profile, calibration
from faultpath.studies.entries import Group, centimetres, success
from faultpath.studies.flights import Flown, Pace
from faultpath.studies.page import Page, Row, TableSpec
from faultpath.studies.pages import PAGES, table_1, table_2
from faultpath.studies.results import Results
from faultpath.studies.run import Plan, conclude, measure_all, plan, read_results, save
from faultpath.work import Here

TINY = Profile("tiny", scenes=2, seeds=(0,))
NOMINAL = table_2.cell("wm-a", 0.0)
FAULTY = table_2.cell("wm-a", 0.1)
ERROR = table_2.error_under(0.1)


def table(*groups: Group) -> TableSpec:
    return TableSpec("one", "One", ("Success, %",), tuple(Row("", (group,)) for group in groups))


ONE = Page("one", "One", (table(success(NOMINAL), success(FAULTY), centimetres(ERROR)),))
TWO = Page("two", "Two", (table(success(NOMINAL)),))


def a_plan(*pages: Page) -> Plan:
    return Plan(pages, TINY, {HELD_OUT: SELECTION})


def fly(asked: Plan, folder: Path) -> Flown:
    return flights.fly(asked.legs(), folder, Here(), lambda now: None, lambda text: None)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the whole of page one."""
    folder = tmp_path_factory.mktemp("run")
    asked = a_plan(ONE)
    flown = fly(asked, folder)
    evidence = measure_all(asked, folder, 0, lambda done, total: None)
    results = Results(flown.outcomes, evidence, asked.library().content_hash)
    save(folder, flown, results, evidence, conclude(asked, flown, results))
    return folder


def test_what_was_saved_is_read_back(run: Path) -> None:
    results, found = read_results(run)
    assert found.trials == 4
    assert found.ledger.library == SELECTION
    assert len(results.pairs(NOMINAL, FAULTY).scenes) == 2
    assert len(results.measured(ERROR).values) > 0
    assert found == Reproduction.model_validate_json(found.model_dump_json())


def test_cells_are_flown_once_for_all_pages(run: Path) -> None:
    flown = fly(a_plan(TWO, ONE), run)
    assert sum(result.blocks_computed for result in flown.results) == 0
    assert len(flown.outcomes.rows) == 4


def test_the_faulty_cell_is_struck_and_pairs_with_the_nominal_one(run: Path) -> None:
    results, _ = read_results(run)
    struck = {
        cell: {row.outcome.struck_steps > 0 for row in results.outcomes.arm("wm-a", cell.path, 0)}
        for cell in (NOMINAL, FAULTY)
    }
    assert struck == {NOMINAL: {False}, FAULTY: {True}}


def test_a_measurement_stands_for_the_library_that_was_named() -> None:
    asked = a_plan(ONE).measurements()
    assert {made.recording.library for made in asked.values()} == {SELECTION}
    assert set(asked) == {ERROR}


def test_a_run_without_measurements_says_which_is_missing(run: Path) -> None:
    results, _ = read_results(run)
    blind = Results(results.outcomes, EvidenceTable({}), results.library_hash)
    with pytest.raises(Exception, match="position-error of wm-a"):
        blind.measured(ERROR)


def test_progress_reaches_the_end(tmp_path: Path) -> None:
    seen: list[Pace] = []
    one = Plan((TWO,), Profile("one", 1, (0,)), {HELD_OUT: SELECTION})
    flights.fly(one.legs(), tmp_path, Here(), seen.append, lambda text: None)
    assert seen[0].trials_done == 0
    assert seen[-1].trials_done == seen[-1].trials_total == 1


def test_a_profile_takes_its_seeds_and_joins_cells_that_share_trials() -> None:
    first, second = Cell(table_1.STILL, "wm-a"), Cell(table_1.STILL, "wm-a", seeds=(1, 2))
    (joined,) = PAPER.cells([first, second])
    assert joined.seeds == (0, 1, 2)
    assert QUICK.cells([second]) == ()
    fine = Cell(table_1.STILL, "wm-a", (calibration(0.05),), quick=False)
    assert QUICK.cells([fine]) == ()
    assert [cell.side for cell in PAPER.cells([fine])] == [fine.side]


def test_a_page_that_the_paper_does_not_have_is_refused() -> None:
    with pytest.raises(UserError, match=r"no page 'table-9'; choose from .*table-1"):
        plan(["table-9"], "quick")
    with pytest.raises(UserError, match="unknown profile 'huge'; choose one of quick, paper"):
        plan([], "huge")


def test_what_a_library_of_ones_own_leaves_alone_is_said() -> None:
    mine = {HELD_OUT: SELECTION}
    assert plan([], "paper").substitution() == ""
    assert plan(["table-4"], "quick", mine).substitution() == (
        "The library selection takes the place of the held-out one."
    )
    said = plan(["table-4", "figure-3", "text-mechanism"], "quick", mine).substitution()
    assert "On the selection library stay, as in the paper: figure-3." in said
    whole = plan([], "paper", mine).substitution()
    assert "figure-3" in whole
    assert "text-planning" in whole


def test_a_file_is_called_by_its_name_without_folder_and_ending() -> None:
    assert stand_in.shown("elsewhere/mine.json") == "mine"
    assert stand_in.shown(SELECTION) == SELECTION


def test_a_library_that_no_page_flies_on_is_refused() -> None:
    with pytest.raises(UserError, match=r"figure-3 is flown on the selection library.*--library"):
        plan(["figure-3"], "quick", {HELD_OUT: SELECTION}).substitution()


def test_all_pages_are_the_whole_paper() -> None:
    assert plan([], "paper").whole
    assert plan(["table-4"], "paper").place == "table-4"
    assert [page.name for page in PAGES] == [page.name for page in plan([], "quick").pages]


def test_a_folder_without_a_reproduction_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="holds no finished reproduction"):
        read_results(tmp_path)
