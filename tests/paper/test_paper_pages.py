"""Pages of the studies: what they need flown, what they show without it, and what is published."""

import re
from collections.abc import Iterator
from functools import cache
from typing import Any

import pytest
from faultpath_paper.answers import Sweep
from faultpath_paper.cells import Cell, published
from faultpath_paper.evidence.table import EvidenceTable
from faultpath_paper.pages import PAGES
from toy_runs import (
    CELLS,
    EMPTY,
    MEASUREMENTS,
    Watched,
    calibrated,
    entries,
    measured,
    page,
    run,
    tables,
    trials,
    won,
)

from faultpath.report.tables import MISSING, Table
from faultpath.run.trials import Trials

NAMES = tuple(page.name for page in PAGES)


@cache
def whole() -> tuple[Trials, EvidenceTable]:
    return trials(CELLS, won(calibrated)), measured(MEASUREMENTS, lambda m: 0.1)


@pytest.mark.parametrize("name", NAMES)
def test_a_page_flies_and_measures_exactly_what_it_reads(name: str) -> None:
    watched = Watched(*whole(), "toy")
    page(name).build(watched)
    flown = {(cell.group, seed) for cell in page(name).cells for seed in cell.seeds}
    read = {(cell.group, seed) for cell in watched.cells for seed in cell.seeds}
    assert set(watched.measurements) == set(page(name).measurements) or name == "text"
    assert read == flown or name == "text"


@pytest.mark.parametrize("name", NAMES)
def test_an_empty_run_leaves_dashes_beside_the_published_figures(name: str) -> None:
    for part in page(name).build(EMPTY):
        if isinstance(part, Sweep):
            assert all(not series.points for series in part.series)
            assert part.published
            continue
        assert {entry.text for entry in entries(part)} <= {MISSING, ""}
        assert all(entry.text == MISSING for entry in entries(part) if entry.published)


@pytest.mark.parametrize("part", [0, 1, 2])
def test_any_part_of_a_run_makes_whole_tables(part: int) -> None:
    cells = [Cell(c.setting, c.variant, c.faults, (part,)) for c in CELLS if part in c.seeds]
    some = run(won(calibrated), cells[part::3], measured(MEASUREMENTS[part::3], lambda m: 0.1))
    for built in (built for each in PAGES for built in each.build(some)):
        if isinstance(built, Table):
            widths = {len(each.entries) for each in built.lines}
            assert widths <= {0, len(built.columns)}
        assert type(built).model_validate_json(built.model_dump_json()) == built


def _figures(value: Any) -> Iterator[float | str]:
    if isinstance(value, dict):
        value = [each for key, each in value.items() if key != "error_span"]  # only a claim has it
    if isinstance(value, list):
        for each in value:
            yield from _figures(each)
    elif value is not None and value != "no crossing":
        yield value


@pytest.mark.parametrize(
    "key",
    [
        "table_1_prediction_accuracy",
        "table_2_calibration",
        "table_3_wind",
        "table_4_shared_calibration",
        "table_5_decision_record",
        "table_6_compensation",
    ],
)
def test_every_published_figure_of_a_table_stands_in_it(key: str) -> None:
    built = tables(page(f"table-{key[6]}"), EMPTY).values()
    shown = " ".join(entry.published for table in built for entry in entries(table))
    words = re.sub(r"[][(),/–]", " ", shown.replace("−", "-").replace("+", "")).split()
    numbers = {float(word) for word in words if re.fullmatch(r"-?[\d.]+", word)}
    for figure in _figures(published(key)):
        assert (figure in words) if isinstance(figure, str) else (figure in numbers)
