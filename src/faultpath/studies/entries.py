"""Entries of tables: our figure as text beside the paper's, and a dash where the run has none."""

from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from typing import Concatenate, ParamSpec

from faultpath.evidence import Measurement
from faultpath.report import wording
from faultpath.statistics import Estimate
from faultpath.studies.cells import Cell
from faultpath.studies.quantities.found import Quantity, Undecidable
from faultpath.studies.quantities.windows import quantile
from faultpath.studies.results import NotRun, Results
from faultpath.tables import MISSING, Entry
from faultpath.trials import Status

P = ParamSpec("P")

BLANK = Entry(text="")
"""Where a column has nothing to say of a line."""


def guarded(make: Callable[P, Entry]) -> Callable[Concatenate[str, P], Entry]:
    """Give `make` the paper's text as first argument, and a dash for ours where it has no trial."""

    @wraps(make)
    def entry(published: str, /, *args: P.args, **named: P.kwargs) -> Entry:
        try:
            made = make(*args, **named)
        except NotRun:
            made = Entry(text=MISSING)
        return made.model_copy(update={"published": published})

    return entry


def printed(value: float, digits: int = 1) -> str:
    """Return a figure of the paper as it prints it: a whole one without digits."""
    return wording.plain(value, 0 if isinstance(value, int) else digits)


def bracket(ends: Sequence[float], digits: int = 1) -> str:
    """Return an interval of the paper as ours are written."""
    low, high = ends
    return f"[{wording.plain(low, digits)}, {wording.plain(high, digits)}]"


@guarded
def success(results: Results, cell: Cell) -> Entry:
    """Success in percent: one decimal for a mean over seeds, none for one seed, as in the paper."""
    rate = results.rate(cell)
    return Entry(text=wording.plain(rate.value, 1 if rate.n_seeds > 1 else 0))


@guarded
def seed_range(results: Results, cell: Cell) -> Entry:
    """Least and greatest success of a seed, percent."""
    per_seed = results.rate(cell).per_seed or ()
    ends = dict.fromkeys(wording.plain(end(per_seed), 0) for end in (min, max))
    return Entry(text="–".join(ends))


@guarded
def ended(results: Results, cell: Cell, status: Status) -> Entry:
    """Share of seed 0's trials that ended in a way, percent; failed trials do not count."""
    counts = results.counts(cell)
    flown = sum(counts.values()) - counts[Status.FAILED]
    if not flown:
        raise NotRun(f"a trial of {results.named(cell)} that did not fail")
    return Entry(text=wording.plain(100 * counts[status] / flown, 0))


@guarded
def successes(results: Results, cell: Cell, scenes: Iterable[int]) -> Entry:
    """Successful scenes among those of some indices, seed by seed, such as `14/15/14`."""
    pairs = results.contrast(cell, cell, scenes=tuple(scenes)).pairs
    return Entry(text="/".join(map(str, pairs.first.success.sum(axis=0))))


@guarded
def time(results: Results, cell: Cell) -> Entry:
    """Median time of seed 0's successful trials, s."""
    return Entry(text=wording.plain(results.median_time(cell), 2))


def of_quantity(
    results: Results,
    quantity: Quantity,
    published: tuple[str, str] = ("", ""),
    digits: int = 1,
    *,
    times: float = 1.0,
) -> tuple[Entry, Entry]:
    """Return a difference that claims may be decided by, in `times` its unit, and its interval.

    Bold is a detected difference in success: all others are secondary.
    """
    try:
        found = quantity(results)
    except (NotRun, Undecidable):
        one, two = (Entry(text=MISSING, published=paper) for paper in published)
        return one, two
    value, ends = MISSING, MISSING
    if found.value is not None:
        value = wording.signed(times * found.value, digits)
    if found.interval is not None:
        ends = bracket([times * end for end in found.interval], digits)
    bold = found.unit == "pp" and bool(found.detected)
    return (
        Entry(text=value, published=published[0], detected=bold),
        Entry(text=ends, published=published[1]),
    )


def interval(estimate: Estimate, digits: int = 1) -> Entry:
    """Return the interval of an estimate."""
    return Entry(text=wording.interval(estimate, digits) or MISSING)


@guarded
def centimetres(results: Results, measurement: Measurement, q: float = 0.5) -> Entry:
    """A quantile over windows of a distance, cm."""
    return Entry(text=wording.plain(100 * quantile(results, measurement, q)))
