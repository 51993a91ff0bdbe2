"""Which acceleration error a shared calibration error leaves on a flight (paper, Eq. 2)."""

from itertools import product
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from faultpath.core.errors import UserError
from faultpath.statistics import Estimate
from faultpath.systems.flightlog.blocks import LEAST, Medians
from faultpath.systems.flightlog.flight import INTERVAL_S, Flight, nominal, through_air
from faultpath.systems.flightlog.reading import Floats

LOW_PASS = 0.5  # paper, appendix
WARM_UP_S = 1.0
"""After the beginning of a stretch, where the observer starts at zero."""

Decided: TypeAlias = Literal["more", "less", "not decided"]


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Combination(_Frozen):
    """What remains with one calibration error in the observer and one in the predictor."""

    observer: float
    predictor: float
    error_mps2: Estimate
    """Median over intervals of the distance between combined and observed acceleration."""
    log_ratio: Estimate | None = None
    """Logarithm of that error over the one with correct calibration; `None` for the latter."""
    decided: Decided | None = None
    """Whether the error is greater or smaller than with correct calibration."""


class SharedAgainstIsolated(_Frozen):
    """The same error in both modules beside the error in the observer alone."""

    error: float
    log_ratio: Estimate
    decided: Decided


class Compensation(_Frozen):
    """What a recorded flight shows of an observer and a predictor that share a calibration."""

    flown_s: float
    intervals: int
    blocks: int
    """Of `block_s` each, which spans several correlation times of the errors."""
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
            "Too little data to decide anything: errors on this flight stay alike for so long that "
            f"it takes at least {LEAST * self.block_s:.0f} s of flight, and {flown_s:.0f} s count."
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
        pairs += [pair for pair in product((0.0, size), repeat=2) if pair != correct]
    of = {pair: _error(flight, settled, *pair) for pair in pairs}
    medians = Medians(flight.stretch[settled], list(of.values()))
    combinations: list[Combination] = []
    for pair in pairs:
        ratio = None if pair == correct else medians.log_ratio(of[pair], of[correct])
        combinations.append(
            Combination(
                observer=pair[0],
                predictor=pair[1],
                error_mps2=medians.value(of[pair], "m/s^2"),
                log_ratio=ratio,
                decided=ratio and _decided(ratio),
            )
        )
    shared = {size: medians.log_ratio(of[size, size], of[size, 0.0]) for size in sizes}
    return Compensation(
        flown_s=len(settled) * INTERVAL_S,
        intervals=int(settled.sum()),
        blocks=medians.blocks,
        block_s=medians.block_s,
        gaps=flight.gaps,
        mass_kg=flight.mass_kg,
        newton_per_unit=flight.newton_per_unit,
        drag_kgps=flight.drag_kgps,
        combinations=tuple(combinations),
        shared=tuple(
            SharedAgainstIsolated(error=size, log_ratio=ratio, decided=_decided(ratio))
            for size, ratio in shared.items()
        ),
    )


def _error(flight: Flight, settled: NDArray[np.bool_], observer: float, predictor: float) -> Floats:
    """Return the error of the combined acceleration at each interval that counts, m/s^2."""
    residual = flight.acceleration_mps2 - nominal(flight, observer)
    raw = through_air(flight, residual * flight.mass_kg * (1 + observer), inverse=True)
    held = np.zeros_like(raw)
    for index in range(1, len(raw)):
        if flight.stretch[index] == flight.stretch[index - 1]:
            held[index] = held[index - 1] + LOW_PASS * (raw[index - 1] - held[index - 1])
    force = through_air(flight, held)
    combined = nominal(flight, predictor) + force / (flight.mass_kg * (1 + predictor))
    found = np.linalg.norm(combined - flight.acceleration_mps2, axis=1)[settled]
    if not np.isfinite(found).all():
        raise UserError(
            "the log and its map leave an acceleration without end: correct mass, drag and units "
            "in the map"
        )
    return found


def _decided(ratio: Estimate) -> Decided:
    low, high = ratio.interval or (0.0, 0.0)
    return "more" if low > 0.0 else "less" if high < 0.0 else "not decided"
