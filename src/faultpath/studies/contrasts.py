"""Contrasts as entries: difference in success, its interval, and who won how often."""

from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass

from faultpath.record import wording
from faultpath.statistics import Contrast
from faultpath.studies.cells import Cell
from faultpath.studies.entries import Figure, Group, Made, bracket, success
from faultpath.studies.page import Columns, Row
from faultpath.studies.quantities.differences import contrast
from faultpath.tables import MISSING, Entry

ROWS = ("Difference", "95 % interval", "Wins:losses")
COLUMNS = (
    "Difference (pp)",
    "95 % interval (pp)",
    "Wins:losses",
    "p",
    "Least detectable (pp)",
)
"""Headings of what `difference` makes: the first as rows, or all as columns."""
COMPARED = ("First (%)", "Second (%)", *COLUMNS)
"""Headings of what `comparison` returns."""


@dataclass(frozen=True)
class PublishedContrast:
    """What the paper prints of a contrast; empty where it prints nothing."""

    difference: str = ""
    interval: str = ""
    wins_losses: str = ""
    p_value: str = ""
    detectable: str = ""


UNPUBLISHED = PublishedContrast()


def published_contrasts(
    differences: Sequence[float],
    intervals: Sequence[Sequence[float]],
    wins_losses: Sequence[Sequence[str]],
) -> tuple[PublishedContrast, ...]:
    """Return contrasts that the paper prints in a row: pp, ends of intervals, `2:15` by seed."""
    return tuple(
        PublishedContrast(wording.signed(pp), bracket(ends), "/".join(counts))
        for pp, ends, counts in zip(differences, intervals, wins_losses, strict=True)
    )


def difference(
    first: Cell,
    second: Cell,
    published: PublishedContrast = UNPUBLISHED,
    *,
    other_noise: bool = False,
) -> Group:
    """Difference, interval, wins:losses, p-value and least detectable difference of two cells."""
    return Group(
        lambda results: _entries(contrast(results, first, second, other_noise=other_noise)),
        astuple(published),
        (first, second),
    )


def differences(
    pairs: Iterable[tuple[Cell, Cell]], published: Sequence[PublishedContrast]
) -> Columns:
    """Return the rows that `ROWS` names, with a column for each pair of cells."""
    columns = zip(pairs, published, strict=True)
    return Columns(ROWS, tuple(difference(*pair, paper) for pair, paper in columns))


def comparison(
    label: str,
    first: Cell,
    second: Cell,
    papers: tuple[Figure, Figure] = ("", ""),
    published: PublishedContrast = UNPUBLISHED,
    *,
    other_noise: bool = False,
) -> Row:
    """Return the success of two cells and their contrast as one row; `papers` are its rates."""
    return Row(
        label,
        (
            success(first, papers[0]),
            success(second, papers[1]),
            difference(first, second, published, other_noise=other_noise),
        ),
    )


def _entries(found: Contrast) -> Made:
    assert found.test is not None
    return (
        decided(found),
        wording.interval(found.estimate()) or MISSING,
        str(found.counts),
        wording.p_value(found.test.p_value),
        "none" if found.least is None else wording.plain(found.least),
    )


def decided(found: Contrast) -> Entry:
    """Return a difference, bold where it is detected."""
    return Entry(text=wording.signed(found.value), detected=bool(found.detected))
