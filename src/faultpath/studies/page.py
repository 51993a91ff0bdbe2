"""A page of the paper: what it needs flown and measured, and what is made of that."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from faultpath.evidence import Measurement
from faultpath.record import Sweep
from faultpath.studies.cells import Cell
from faultpath.studies.results import Results
from faultpath.tables import Table

Built: TypeAlias = tuple[Table | Sweep, ...]


def _drawn(results: Results) -> Built:
    """Build nothing: the report draws the page from what it is given."""
    del results
    return ()


@dataclass(frozen=True)
class Page:
    """One table or figure of the paper, or its results in the text."""

    name: str
    """Such as `table-2`."""
    title: str
    cells: tuple[Cell, ...] = ()
    measurements: tuple[Measurement, ...] = ()
    build: Callable[[Results], Built] = _drawn
    """Makes tables and figures of any part of the cells and measurements; never raises `NotRun`."""
