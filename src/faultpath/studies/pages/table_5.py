"""Table V: from which fault frequency on each repair pays."""

from faultpath.studies.cells import Cell
from faultpath.studies.pages import table_2, table_4

REPAIRS: dict[str, tuple[Cell, Cell, Cell, Cell]] = {
    "WM-A": tuple(
        table_2.cell(model, error) for error in (0.0, 0.1) for model in ("wm-a+dcc", "wm-a")
    ),
    "WM-U": tuple(
        table_2.cell(model, error) for error in (0.0, 0.1) for model in ("wm-u+dcc", "wm-u")
    ),
    **{
        f"GRU/{path}": tuple(
            table_4.cell(method, at) for at in ("correct", path) for method in ("gru+dcc", "gru")
        )
        for path in ("reconstruction-only", "shared")
    },
}
"""Repair and baseline under correct inputs, then both under the fault; keys as published."""

CELLS = tuple(cell for cells in REPAIRS.values() for cell in cells)
MEASUREMENTS = ()
