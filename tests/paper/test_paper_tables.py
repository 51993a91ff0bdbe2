"""Tables of the studies: what the shipped run, whose tables are all compared, does not show."""

from faultpath_paper.cells import Cell
from faultpath_paper.evidence.table import Measurement
from faultpath_paper.pages import table_3, table_4, table_6
from faultpath_quadrotor.training import trajectories
from toy_runs import SCENES, calibrated, line, measured, page, papers, run, tables, texts, won

from faultpath.system import Status


def test_table_1_counts_how_trials_end_and_when() -> None:
    def ends(cell: Cell, seed: int, scene: int) -> Status:
        if cell.variant == "dki" and scene == SCENES - 1:
            return Status.FAILED
        if scene < 12:
            return Status.SUCCESS
        return Status.CRASH if scene < 14 else Status.TIMEOUT

    table = tables(page("table-1"), run(ends))["table-1"]
    assert texts(line(table, "WM-A"))[2:] == ["60", "10", "30", "3.55"]
    assert papers(line(table, "WM-A")) == ["8.2", "9.5", "69", "21", "10", "2.75"]
    # Of 19 trials: the one that failed says nothing.
    assert texts(line(table, "DKI"))[2:5] == ["63", "11", "26"]
    assert texts(line(table, "True-parameter", below="With ground-truth clearance"))[2] == "60"


def test_what_the_paper_prints_below_table_1_is_of_common_successes() -> None:
    def ends(cell: Cell, seed: int, scene: int) -> Status:
        won = scene < 12 + seed and (cell.variant, scene) != ("dki", 3)
        return Status.SUCCESS if won else Status.CRASH

    table = tables(page("table-1"), run(ends))["table-1b"]
    assert texts(line(table, "DKI"))[::2] == ["0.00", "11"]
    assert texts(line(table, "True-parameter"))[::2] == ["0.00", "12"]
    assert papers(line(table, "DKI")) == ["+1.40", "", "65", ""]
    assert texts(line(table, "WM-U")) == ["", "", "", "60 to 70"]
    assert papers(line(table, "WM-A"))[-1] == "68 to 71"


def test_scenes_whose_wind_was_not_met_are_counted_apart() -> None:
    def ends(cell: Cell, seed: int, scene: int) -> Status:
        return Status.SUCCESS if scene < 75 + seed else Status.CRASH

    results = run(ends, page("table-3").cells, scenes=range(60, 80))
    table = tables(page("table-3"), results)["table-3b"]
    assert texts(line(table, "Wind-conditioned, trajectory GRU")) == ["5/6/7", "5/6/7"]
    assert texts(line(table, "Wind-conditioned, zero")) == ["5", "5"]
    assert papers(line(table, "Wind-conditioned, ground truth")) == ["30", "19"]
    assert table_3.UNMET.start == trajectories.SCENES


def _reconstructed(cell: Cell) -> int:
    """GRU falls under the isolated error and recovers under the shared one; GRU+DCC stays."""
    alone = any("reconstruction" in fault for fault in cell.faults)
    return 10 if cell.variant == "gru+dcc" else 4 if alone else 16


def test_tables_4_to_6_show_the_reversal_its_changes_and_when_it_pays() -> None:
    results = run(won(_reconstructed))
    table = tables(page("table-4"), results)["table-4"]
    difference = line(table, "Difference", below="GRU+DCC minus GRU, success (pp)")
    assert texts(difference) == ["−30.0", "+30.0", "−30.0"]
    assert all(entry.detected for entry in difference.entries)
    interaction = line(table, "DOB minus GRU, shared minus reconstruction-only (pp)")
    assert texts(interaction) == ["", "", "0.0"]
    # Each scene that is lost ends 2 m farther away.
    assert texts(line(table, "Mean difference")) == ["+0.60", "−0.60", "+0.60"]
    assert texts(line(table, "Shared minus reconstruction-only (m)"))[2] == "+1.20"

    table = tables(page("table-5"), results)["table-5"]
    *changes, pays = texts(line(table, "GRU: reconstruction only"))[:3]
    assert changes[:2] == ["−30.0", "+30.0"]
    assert pays.startswith("50 [")
    low, high = (int(end) for end in pays.partition("[")[2].strip("]").split(", "))
    assert 0 < low < 50 < high < 100
    assert papers(line(table, "GRU: reconstruction only"))[2] == "59 [33, 80]"
    assert texts(line(table, "GRU: shared with predictor"))[2] == "no crossing"

    table = tables(page("table-6"), results)["table-6b"]
    assert texts(line(table, "GRU+DCC only:GRU only")) == ["0:6", "6:0", "0:6"]
    assert texts(line(table, "Exact McNemar p")) == ["0.031"] * 3
    assert papers(line(table, "Exact McNemar p")) == ["0.002", "0.648", "0.057"]


def test_the_observer_flies_once_and_is_compared_with_each_trained_seed() -> None:
    def ends(cell: Cell, seed: int, scene: int) -> Status:
        wins = 10 + seed if cell.variant == "gru" else 10
        return Status.SUCCESS if scene < wins else Status.CRASH

    results = run(ends)
    table = tables(page("table-4"), results)["table-4"]
    assert texts(line(table, "DOB"))[0] == "50"  # of one run: no decimals
    heading = "DOB minus GRU, success (pp)"
    assert texts(line(table, "Wins:losses", below=heading))[0] == "0:0/0:1/0:2"
    assert texts(line(table, "Difference", below=heading))[0] == "−5.0"
    dob = table_4.cell("dob", "correct")
    assert (dob.fixed, dob.seeds, results.pairs(dob, dob).seeds) == (True, (0,), (0,))


def test_table_6_averages_the_medians_of_the_seeds() -> None:
    def value(measurement: Measurement) -> float:
        return 1.0 + measurement.seed

    evidence = measured(table_6.PAGE.measurements, value)
    table = tables(page("table-6"), run(won(calibrated), evidence=evidence))["table-6a"]
    assert texts(line(table, "GRU")) == ["2.00"] * 4
    assert texts(line(table, "DOB")) == ["1.00"] * 4
    assert texts(line(table, "GRU, wind term alone")) == ["", "2.00", "", "2.00"]
    first = measured([m for m in table_6.PAGE.measurements if m.seed == 0], value)
    table = tables(page("table-6"), run(won(calibrated), evidence=first))["table-6a"]
    assert texts(line(table, "GRU")) == ["1.00"] * 4
