"""Entries of tables as data: what each is made of, how, and the paper's figure beside it."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import astuple, dataclass

import numpy as np

from faultpath.report.sentences import wording
from faultpath.report.tables import MISSING, Entry
from faultpath.stats.contrast import Contrast
from faultpath.system import Status
from faultpath_paper.cells import Cell, of_seed
from faultpath_paper.detection import detection, least_detectable, resampled
from faultpath_paper.evidence.table import Measurement
from faultpath_paper.quantities.differences import contrast
from faultpath_paper.quantities.windows import mean_of_medians
from faultpath_paper.results import NotRun, Quantity, Results, Undecidable

Made = Sequence[Entry | str]
Figure = float | str
"""A figure of the paper: as text, or as the number that it prints; empty where it prints none."""


@dataclass(frozen=True)
class EntryGroup:
    """Entries that are made together; all are dashes where a run does not hold them."""

    make: Callable[[Results], Made]
    published: tuple[str, ...] = ("",)
    """The paper's figures, one an entry."""
    cells: tuple[Cell, ...] = ()
    measurements: tuple[Measurement, ...] = ()

    def entries(self, results: Results) -> tuple[Entry, ...]:
        """Return our figures beside the paper's."""
        try:
            ours = self.make(results)
        except (NotRun, Undecidable):
            ours = [MISSING] * len(self.published)
        entries = (Entry(text=entry) if isinstance(entry, str) else entry for entry in ours)
        return tuple(
            entry.model_copy(update={"published": paper})
            for entry, paper in zip(entries, self.published, strict=True)
        )


BLANK = EntryGroup(lambda results: ("",))
"""Group of a column that is empty in a line."""


def printed(figure: Figure, digits: int = 1) -> str:
    """Return a figure of the paper as it prints it: a whole one without digits."""
    if isinstance(figure, str):
        return figure
    return wording.plain(figure, 0 if isinstance(figure, int) else digits)


def success(cell: Cell, paper: Figure = "") -> EntryGroup:
    """Success in percent: one decimal for a mean over seeds, none for one seed, as in the paper."""

    def make(results: Results) -> Made:
        rate = results.rate(cell)
        return (wording.plain(rate.value, 1 if rate.n_seeds > 1 else 0),)

    return EntryGroup(make, (printed(paper),), (cell,))


def ended(cell: Cell, status: Status, paper: Figure = "") -> EntryGroup:
    """Share of seed 0's trials that ended in a way, percent; failed trials do not count."""

    def make(results: Results) -> Made:
        ends = [outcome.status for outcome in results.first(cell)]
        return (wording.plain(100 * ends.count(status) / len(ends), 0),)

    return EntryGroup(make, (printed(paper),), (of_seed(cell),))


def time(cell: Cell, paper: float) -> EntryGroup:
    """Median time of seed 0's successful trials, s."""

    def make(results: Results) -> Made:
        times = [e.time_s for e in results.first(cell) if e.status is Status.SUCCESS]
        return (wording.plain(float(np.median(times)), 2) if times else MISSING,)

    return EntryGroup(make, (printed(paper, 2),), (of_seed(cell),))


def measured(
    by_seed: Iterable[Measurement], paper: Figure = "", *, times: float = 1.0, digits: int = 2
) -> EntryGroup:
    """Mean over seeds of the median over windows, in `times` its unit."""
    subject = tuple(by_seed)
    return EntryGroup(
        lambda results: (wording.plain(times * mean_of_medians(results, subject), digits),),
        (printed(paper, digits),),
        measurements=subject,
    )


def centimetres(measurement: Measurement, paper: Figure = "") -> EntryGroup:
    """Median over windows of a distance, cm."""
    return measured((measurement,), paper, times=100, digits=1)


def of_quantity(
    quantity: Quantity, cells: Iterable[Cell], published: tuple[str, str], digits: int
) -> EntryGroup:
    """A difference that claims may be decided by, its interval, and beside it the score's.

    Bold is a detected difference in success.
    """

    def make(results: Results) -> Made:
        effect = quantity(results)
        as_paper = resampled(effect)
        bold = effect.unit == "pp" and bool(detection(as_paper))
        entry = Entry(text=wording.signed(effect.value, digits), detected=bold)
        return entry, interval_of(as_paper, digits), interval_of(effect, digits)

    return EntryGroup(make, (*published, ""), tuple(cells))


def interval_of(effect: Contrast, digits: int = 1) -> str:
    """Return an interval as the paper's are written; a dash without one."""
    return wording.bracket(effect.interval, digits) if effect.interval else MISSING


@dataclass(frozen=True)
class PublishedContrast:
    """A contrast as the paper prints it; empty where it prints nothing."""

    difference: str = ""
    interval: str = ""
    score: str = ""
    wins_losses: str = ""
    p_value: str = ""
    detectable: str = ""


def published_contrasts(
    pp: Sequence[float], ci95: Sequence[Sequence[float]], wins_losses: Sequence[Sequence[str]]
) -> tuple[PublishedContrast, ...]:
    """Return contrasts that the paper prints in a row: pp, ends of intervals, `2:15` by seed."""
    return tuple(
        PublishedContrast(
            wording.signed(value), wording.bracket(ends), wins_losses="/".join(counts)
        )
        for value, ends, counts in zip(pp, ci95, wins_losses, strict=True)
    )


def difference(first: Cell, second: Cell, published: PublishedContrast) -> EntryGroup:
    """Difference, its two intervals, wins:losses, p-value and least detectable difference."""

    def make(results: Results) -> Made:
        effect = contrast(results, first, second)
        assert effect.test is not None
        least = least_detectable(effect)
        return (
            decided(effect),
            *map(interval_of, (resampled(effect), effect)),
            wording.won(effect.won or ()),
            wording.p_value(effect.test.p_value),
            "none" if least is None else wording.plain(least),
        )

    return EntryGroup(make, astuple(published), (first, second))


def decided(effect: Contrast) -> Entry:
    """Return a difference, bold where it is detected."""
    bold = bool(detection(resampled(effect)))
    return Entry(text=wording.signed(effect.value), detected=bold)
