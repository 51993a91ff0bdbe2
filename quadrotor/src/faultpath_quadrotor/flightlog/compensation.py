"""Which acceleration error a shared calibration error leaves on a flight (paper, Eq. 2)."""

from collections.abc import Sequence
from itertools import combinations as pairs_of
from itertools import pairwise
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.signal import correlate

from faultpath.plugin.results import N_RESAMPLES, Contrast, Estimate, WindowQuantiles, t_quantile
from faultpath.plugin.system import Frozen, UserError
from faultpath_quadrotor.flightlog.flight import INTERVAL_S, Flight, nominal, through_air
from faultpath_quadrotor.flightlog.reading import Floats

LEAST_S = 2.0
"""No block is shorter."""
TIMES = 4.0
"""Integrated correlation times that a block spans: what neighbours still share is then little."""
LEAST = 8
"""With fewer blocks nothing is decided, and no interval is given."""
_WINDOW = 5.0
"""Correlation times up to which correlations are summed; what lies beyond is noise (Sokal)."""
LOW_PASS = 0.5  # paper, appendix
WARM_UP_S = 1.0
"""After the beginning of a stretch, where the observer starts at zero."""

Decided: TypeAlias = Literal["more", "less", "not decided"]


class Combination(Frozen):
    """Error with one calibration error in the observer and one in the predictor."""

    observer: float
    predictor: float
    error_mps2: Estimate
    """Median over intervals of the distance between combined and observed acceleration."""
    log_ratio: Estimate | None = None
    """Logarithm of that error over the one with correct calibration; `None` for the latter."""
    decided: Decided | None = None
    """Whether the error is greater or smaller than with correct calibration."""


class SharedAgainstIsolated(Frozen):
    """The same error in both modules beside the error in the observer alone."""

    error: float
    log_ratio: Estimate
    decided: Decided


class Compensation(Frozen):
    """Errors on a recorded flight of an observer and a predictor that share a calibration."""

    flown_s: float
    intervals: int
    blocks: int
    """Blocks of `block_s` each, which spans several correlation times of the errors."""
    block_s: float
    gaps: int
    mass_kg: float
    newton_per_unit: float
    drag_kgps: tuple[float, float, float] | None
    combinations: tuple[Combination, ...]
    shared: tuple[SharedAgainstIsolated, ...]

    @property
    def too_short(self) -> str:
        """Why nothing is decided, as a sentence; empty where the flight is long enough."""
        if self.blocks >= LEAST:
            return ""
        flown_s = self.intervals * INTERVAL_S
        return (
            "Too little data: errors on this flight stay alike for so long that at least "
            f"{LEAST * self.block_s:.0f} s of flight are needed, and {flown_s:.0f} s count."
        )


@np.errstate(all="ignore")  # what comes of it is judged
def compensation(flight: Flight, sizes: tuple[float, ...] = (0.1, -0.1)) -> Compensation:
    """Return the error of a_0 + B w for correct, isolated and shared calibration errors.

    A disturbance observer reconstructs the wind w (without drag: the force) from each interval's
    residual, low-pass filtered; the predictor reuses it one interval later. Intervals resample
    blocks of the flight, several correlation times long (`Medians`); with too few of them there is
    none, and nothing is decided.

    Args:
        flight: What was recorded.
        sizes: Calibration errors e: mass (1 + e), thrust (1 - e).

    Raises:
        UserError: A size leaves no positive mass or thrust, or nothing of the flight counts.
    """
    for size in sizes:
        if not -1 < size < 1 or size == 0:
            raise UserError(f"the calibration error {size:g} is not between -1 and 1, or is 0")
    begins = np.searchsorted(flight.stretch, flight.stretch)
    settled = flight.time_s - flight.time_s[begins] >= WARM_UP_S - 1e-9
    correct = (0.0, 0.0)
    pairs = [correct]
    for size in sizes:
        pairs += [(0.0, size), (size, 0.0), (size, size)]
    errors = {pair: _error(flight, settled, *pair) for pair in pairs}
    medians = Medians(flight.stretch[settled], list(errors.values()))
    ratios = {pair: medians.log_ratio(errors[pair], errors[correct]) for pair in pairs[1:]}
    shared = {size: medians.log_ratio(errors[size, size], errors[size, 0.0]) for size in sizes}
    return Compensation(
        flown_s=len(settled) * INTERVAL_S,
        intervals=int(settled.sum()),
        blocks=medians.blocks,
        block_s=medians.block_s,
        gaps=flight.gaps,
        mass_kg=flight.mass_kg,
        newton_per_unit=flight.newton_per_unit,
        drag_kgps=flight.drag_kgps,
        combinations=tuple(
            Combination(
                observer=pair[0],
                predictor=pair[1],
                error_mps2=medians.value(errors[pair], "m/s^2"),
                log_ratio=ratios.get(pair),
                decided=_decided(ratios[pair]) if pair in ratios else None,
            )
            for pair in pairs
        ),
        shared=tuple(
            SharedAgainstIsolated(error=size, log_ratio=ratio, decided=_decided(ratio))
            for size, ratio in shared.items()
        ),
    )


def _error(flight: Flight, settled: NDArray[np.bool_], observer: float, predictor: float) -> Floats:
    """Return the error of the combined acceleration at each interval that counts, m/s^2."""
    residual = flight.acceleration_mps2 - nominal(flight, observer)
    raw = through_air(flight, residual * flight.mass_kg * (1 + observer), inverse=True)
    filtered = np.zeros_like(raw)
    for index in range(1, len(raw)):
        if flight.stretch[index] == flight.stretch[index - 1]:
            before = filtered[index - 1]
            filtered[index] = before + LOW_PASS * (raw[index - 1] - before)
    force = through_air(flight, filtered)
    combined = nominal(flight, predictor) + force / (flight.mass_kg * (1 + predictor))
    error = np.linalg.norm(combined - flight.acceleration_mps2, axis=1)[settled]
    if not np.isfinite(error).all():
        raise UserError(
            "the log and its map leave an acceleration without end: correct mass, drag and units "
            "in the map"
        )
    return error


def _decided(ratio: Estimate) -> Decided:
    low, high = ratio.interval or (0.0, 0.0)
    return "more" if low > 0.0 else "less" if high < 0.0 else "not decided"


class Medians:
    """Medians over the intervals of a flight and their ratios, with intervals by blocks.

    Neighbouring intervals share wind and manoeuvre, so a flight holds fewer independent values than
    intervals. A block spans several correlation times, blocks are resampled, and the quantile is
    that of Student's t with their number: few blocks do not know their own spread.

    Args:
        stretch: Number of the stretch of each interval, `[N]`, ascending.
        errors: All series `[N]` that are to be compared; the block suits the slowest of them.
        n_resamples: Of the blocks.
    """

    def __init__(
        self, stretch: Floats, errors: Sequence[Floats], n_resamples: int = N_RESAMPLES
    ) -> None:
        # A ratio above its median: logarithms, of which none is infinite.
        logs = [np.log(np.maximum(error, np.finfo(np.float64).tiny)) for error in errors]
        compared = [*logs, *(one - two for one, two in pairs_of(logs, 2))]
        slowest = max(correlation_time(series, stretch) for series in compared)
        length = max(round(LEAST_S / INTERVAL_S), int(np.ceil(TIMES * slowest)))
        self.block_s = length * INTERVAL_S
        """How long a block is."""
        within = (np.arange(len(stretch)) - np.searchsorted(stretch, stretch)) // length
        names = [f"{one:g}/{two}" for one, two in zip(stretch, within, strict=True)]
        self.blocks = min(len(set(names)), len(stretch) // length)
        """Whole blocks in all intervals together."""
        self._windows = WindowQuantiles(names, n_resamples=n_resamples)

    def value(self, errors: Floats, unit: str) -> Estimate:
        """Return the median of positive errors `[N]`."""
        median = self._windows.value(errors, 0.5, unit)
        factor = np.exp(self._half(np.log(median.draws)))
        return self._estimate(median, median.value / factor, median.value * factor)

    def log_ratio(self, one: Floats, two: Floats) -> Estimate:
        """Return the logarithm of the ratio of two medians."""
        ratio = self._windows.log_ratio(one, two, 0.5)
        half = self._half(ratio.draws)
        return self._estimate(ratio, ratio.value - half, ratio.value + half)

    def _half(self, draws: Floats) -> float:
        """Return half the width of an interval, not a number where there are too few blocks."""
        if self.blocks < LEAST:
            return float("nan")
        # A resample of K blocks has (K - 1) / K of the variance.
        spread = float(draws.std()) * np.sqrt(self.blocks / (self.blocks - 1.0))
        return spread * t_quantile(0.975, self.blocks - 1)

    def _estimate(self, contrast: Contrast, low: float, high: float) -> Estimate:
        name, method, ends = contrast.method.partition(",")[0], "too few blocks", (None, None)
        if np.isfinite([low, high]).all():
            ends = low, high
            method = (
                f"t interval from {self.blocks} resampled blocks of {round(self.block_s, 1):g} s"
            )
        return contrast.estimate().model_copy(
            update={"low": ends[0], "high": ends[1], "method": f"{name}, {method}"}
        )


def correlation_time(series: Floats, stretch: Floats) -> float:
    """Return the integrated correlation time of a series `[N]` about its median, in intervals.

    It is that of being above the median, which has moments whatever the series is. 1 where
    neighbours are independent; pairs are taken within a stretch.
    """
    above = np.where(series > np.median(series), 0.5, -0.5)
    edges = [0, *(np.flatnonzero(np.diff(stretch)) + 1), len(series)]
    sums = np.zeros(len(series))
    for begin, end in pairwise(edges):
        part = above[begin:end] - above.mean()
        sums[: len(part)] += correlate(part, part, method="fft")[len(part) - 1 :]
    if not sums[0] > 0.0:
        return 1.0
    summed: NDArray[np.float64] = 2.0 * np.cumsum(sums / sums[0]) - 1.0
    enough = np.flatnonzero(np.arange(len(series)) >= _WINDOW * summed)
    return max(1.0, float(summed[enough[0] if len(enough) else -1]))
