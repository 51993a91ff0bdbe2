"""Contrasts as entries: difference in success, its interval, and who won how often."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import astuple, dataclass

from faultpath.report import wording
from faultpath.studies.cells import Cell
from faultpath.studies.entries import bracket, interval, success
from faultpath.studies.results import Contrast, NotRun, Results
from faultpath.tables import MISSING, Entry, Line

ROWS = ("Difference", "95 % interval", "Wins:losses")
COLUMNS = (
    "Difference (pp)",
    "95 % interval (pp)",
    "Wins:losses",
    "p",
    "Least detectable (pp)",
)
"""Headings of what `contrast_entries` returns: the first as rows, or all as columns."""
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


def attempt(make: Callable[[], Sequence[Entry]], published: Sequence[str]) -> tuple[Entry, ...]:
    """Return entries that are made together, beside the paper's; dashes where nothing was run."""
    try:
        ours = make()
    except NotRun:
        ours = [Entry(text=MISSING)] * len(published)
    return tuple(
        entry.model_copy(update={"published": text})
        for entry, text in zip(ours, published, strict=True)
    )


def contrast_entries(
    results: Results,
    first: Cell,
    second: Cell,
    published: PublishedContrast = UNPUBLISHED,
    *,
    other_noise: bool = False,
) -> tuple[Entry, ...]:
    """Return difference, interval, wins:losses, p-value and least detectable difference."""
    return attempt(
        lambda: _entries(results.contrast(first, second, other_noise=other_noise)),
        astuple(published),
    )


def contrast_lines(
    results: Results,
    pairs: Iterable[tuple[Cell, Cell]],
    published: Sequence[PublishedContrast],
) -> tuple[Line, ...]:
    """Return the rows that `ROWS` names, with a column for each pair of cells."""
    columns = [
        contrast_entries(results, first, second, paper)[: len(ROWS)]
        for (first, second), paper in zip(pairs, published, strict=True)
    ]
    rows = zip(*columns, strict=True)
    return tuple(
        Line(label=label, entries=entries) for label, entries in zip(ROWS, rows, strict=True)
    )


def comparison(
    results: Results,
    label: str,
    first: Cell,
    second: Cell,
    rates: tuple[str, str] = ("", ""),
    published: PublishedContrast = UNPUBLISHED,
    *,
    other_noise: bool = False,
) -> Line:
    """Return the success of two cells and their contrast as one row; `rates` are the paper's."""
    return Line(
        label=label,
        entries=(
            success(rates[0], results, first),
            success(rates[1], results, second),
            *contrast_entries(results, first, second, published, other_noise=other_noise),
        ),
    )


def _entries(contrast: Contrast) -> tuple[Entry, ...]:
    least = contrast.detectable.value
    return (
        Entry(text=wording.signed(contrast.success.value), detected=bool(contrast.detected_sign)),
        interval(contrast.success),
        Entry(text=str(contrast.counts)),
        Entry(text=wording.p_value(contrast.test.p_value)),
        Entry(text="none" if least is None else wording.plain(least)),
    )
