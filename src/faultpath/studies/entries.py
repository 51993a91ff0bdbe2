"""Entries of tables: our figure as text beside the paper's, and a dash where the run has none."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import wraps
from typing import Concatenate, ParamSpec

import numpy as np

from faultpath.evidence import Measurement
from faultpath.record import MISSING, Entry
from faultpath.report import wording
from faultpath.statistics import Estimate
from faultpath.studies.cells import Cell
from faultpath.studies.results import NotRun, Results
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


def of_seed(cell: Cell, seed: int = 0) -> Cell:
    """Return a cell with one of its seeds alone."""
    return replace(cell, seeds=(seed,))


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
        raise NotRun(f"a trial of {cell} that did not fail")
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


@guarded
def time_difference(results: Results, first: Cell, second: Cell) -> Entry:
    """Median difference in time over jointly successful scenes, s, with their number."""
    found = results.contrast(first, second).time()
    text = f"{wording.with_interval(found, 2)} (n = {found.n_scenes})"
    return Entry(text=text, detected=bool(found.detected_sign))


def difference(estimate: Estimate, digits: int = 1) -> Entry:
    """Return a difference that is no success: detected where its interval excludes 0."""
    text = wording.signed(estimate.value, digits)
    return Entry(text=text, detected=bool(estimate.detected_sign))


def interval(estimate: Estimate, digits: int = 1) -> Entry:
    """Return the interval of an estimate."""
    return Entry(text=wording.interval(estimate, digits) or MISSING)


def quantile(results: Results, measurement: Measurement, q: float = 0.5) -> float:
    """Return a quantile over windows; `NotRun` without any."""
    values = results.measured(measurement).values
    if not len(values):
        raise NotRun(f"a window for {measurement.subject}")
    return float(np.quantile(values, q))


def mean_of_medians(results: Results, by_seed: Iterable[Measurement]) -> float:
    """Return the mean over seeds of their window medians, over the seeds that were measured."""
    medians: list[float] = []
    missing = NotRun("a measurement")
    for measurement in by_seed:
        try:
            medians.append(quantile(results, measurement))
        except NotRun as reason:
            missing = reason
    if not medians:
        raise missing
    return float(np.mean(medians))


@guarded
def centimetres(results: Results, measurement: Measurement, q: float = 0.5) -> Entry:
    """A quantile over windows of a distance, cm."""
    return Entry(text=wording.plain(100 * quantile(results, measurement, q)))
