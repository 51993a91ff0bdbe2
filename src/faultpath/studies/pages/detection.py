"""Detection sensitivity: what the contrasts could have shown that the paper finds no difference in.

The paper keeps these calculations in its reproduction record; not detecting a difference is not
equivalence.
"""

from collections.abc import Iterator
from itertools import combinations

from faultpath.studies.cells import Cell, of_seed
from faultpath.studies.contrasts import COLUMNS, UNPUBLISHED, PublishedContrast, difference
from faultpath.studies.notes import INTERVALS, LEAST, WINS
from faultpath.studies.page import Page, Row, TableSpec
from faultpath.studies.pages import in_text, table_1, table_2, table_3, table_4, table_6


def _row(
    label: str,
    first: Cell,
    second: Cell,
    paper: PublishedContrast = UNPUBLISHED,
    *,
    other_noise: bool = False,
) -> Row:
    return Row(label, (difference(first, second, paper, other_noise=other_noise),))


def _predictors() -> Iterator[Row]:
    names = dict(zip(table_1.PREDICTORS, ("DKI", "WM-A", "WM-U", "true-parameter"), strict=True))
    for first, second in combinations(table_1.PREDICTORS, 2):
        label = f"{names[first]} minus {names[second]}, seed 0"
        yield _row(label, of_seed(first), of_seed(second))
    nominal = table_2.ERRORS.index(0.0)
    for repair, baseline in table_2.PAIRS:
        yield _row(
            f"{table_2.NAMES[repair]} minus {table_2.NAMES[baseline]}, correct calibration",
            table_2.cell(repair, 0.0),
            table_2.cell(baseline, 0.0),
            table_2.published_repairs(baseline)[nominal],
        )


def _wind() -> Iterator[Row]:
    for environment in table_3.ENVIRONMENTS:
        where = environment.replace("-", " ")
        for level in ("L2", "L3"):
            yield _row(
                f"Zero wind input minus wind-withheld, {where}, {level}",
                table_3.cell(table_3.ZERO, environment, level),
                table_3.cell(table_3.WITHHELD, environment, level),
            )
        yield _row(
            f"GRU minus ground-truth wind, {where}, L3",
            table_3.cell(table_3.GRU, environment, "L3"),
            table_3.cell(table_3.TRUE, environment, "L3"),
        )


def _shared_calibration() -> Iterator[Row]:
    yield _row(
        "GRU, shared error minus correct",
        table_4.cell("gru", "shared"),
        table_4.cell("gru", "correct"),
    )
    papers = table_4.published_methods("dob", "gru")
    for path, paper in zip(table_4.PATHS, papers, strict=True):
        first, second = table_4.cell("dob", path), table_4.cell("gru", path)
        yield _row(f"DOB minus GRU, {path}", first, second, paper)
    for path, paper in zip(table_6.NEGATIVE, table_6.published_negative(), strict=True):
        if path != "correct":
            first, second = table_6.negative("gru+dcc", path), table_6.negative("gru", path)
            yield _row(f"GRU+DCC minus GRU, e = −0.1, {path}, seed 0", first, second, paper)


def _others() -> Iterator[Row]:
    yield _row(
        "History code of WM-A+DCC frozen minus updated",
        in_text.CODE_FROZEN,
        of_seed(in_text.CODE_UPDATED),
    )
    yield _row(
        "History code of the wind-withheld model frozen minus updated",
        in_text.WITHHELD_FROZEN,
        in_text.WITHHELD_UPDATED,
    )
    for label, planner in in_text.OTHER_PLANNERS.items():
        yield _row(
            f"{label} minus 512 candidates", planner, in_text.REFERENCE_PLANNER, other_noise=True
        )


TITLE = "Detection sensitivity of contrasts without a detected difference"
PAGE = Page(
    "detection-sensitivity",
    TITLE,
    (
        TableSpec(
            name="detection-sensitivity",
            title=TITLE,
            columns=COLUMNS,
            rows=(*_predictors(), *_wind(), *_shared_calibration(), *_others()),
            notes=("{flown}", LEAST, WINS, INTERVALS),
        ),
    ),
)
