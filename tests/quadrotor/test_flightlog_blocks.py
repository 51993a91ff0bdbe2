"""Errors that stay alike for seconds: blocks are longer than that, or nothing is decided."""

from pathlib import Path

import numpy as np
import pytest
from faultpath_quadrotor.flightlog.compensation import (
    LEAST,
    LEAST_S,
    Medians,
    compensation,
    correlation_time,
)
from faultpath_quadrotor.flightlog.flight import INTERVAL_S
from faultpath_quadrotor.flightlog.words import sentences
from flight_logs import flown, read, write
from scipy.signal import lfilter


def drifting(rng: np.random.Generator, seconds: float, alike_s: float) -> np.ndarray:
    """Return two series of errors with one median, correlated with each other and over time."""
    keep = np.exp(-INTERVAL_S / alike_s)
    noise = rng.normal(size=(2, round(seconds / INTERVAL_S)))
    noise[:, 1:] *= np.sqrt(1.0 - keep**2)
    series = lfilter([1.0], [1.0, -keep], noise, axis=1)
    series[1] = 0.5 * series[0] + np.sqrt(0.75) * series[1]
    return np.exp(0.3 * series)


@pytest.mark.parametrize(("alike_s", "seconds"), [(3.0, 120.0), (10.0, 300.0)])
def test_errors_with_one_median_are_seldom_told_apart(alike_s: float, seconds: float) -> None:
    """Blocks of 2 s told them apart in a fifth of such flights; .05 is promised."""
    rng, flights, false = np.random.default_rng(5), 80, 0
    for _ in range(flights):
        one, two = drifting(rng, seconds, alike_s)
        medians = Medians(np.zeros(len(one)), [one, two], n_resamples=60)
        low, high = medians.log_ratio(one, two).interval or (0.0, 0.0)
        false += low > 0.0 or high < 0.0
    assert false <= 0.125 * flights  # .05 and three standard errors


@pytest.mark.parametrize("alike_s", [0.5, 3.0])
def test_a_block_spans_the_time_that_errors_stay_alike(alike_s: float) -> None:
    series = drifting(np.random.default_rng(2), 2000.0, alike_s)
    stretch = np.zeros(len(series[0]))
    # Signs of a Gaussian series are alike for less long than its values, whose time is 2 `alike_s`.
    assert 1.2 * alike_s < INTERVAL_S * correlation_time(series[0], stretch) < 2.2 * alike_s
    found = Medians(stretch, list(series), n_resamples=10)
    assert found.block_s > 4 * alike_s
    assert found.blocks == pytest.approx(2000.0 / found.block_s, rel=0.1)
    rough = Medians(stretch, [np.random.default_rng(3).random(len(stretch))], n_resamples=10)
    assert rough.block_s == LEAST_S


def test_pairs_across_a_gap_do_not_count() -> None:
    alternating = np.resize([1.0, 2.0], 400)
    assert correlation_time(alternating, np.zeros(400)) == 1.0
    halves = np.repeat([1.0, 2.0], 200)
    assert correlation_time(halves, np.arange(400.0)) == 1.0
    assert correlation_time(halves, np.zeros(400)) > 40.0
    assert correlation_time(np.ones(400), np.zeros(400)) == 1.0


def test_too_short_a_flight_decides_nothing_and_says_what_it_takes(tmp_path: Path) -> None:
    short = compensation(read(write(tmp_path / "flight.csv", flown(18.0))))
    assert short.blocks < LEAST
    assert sentences(short) == (short.too_short,)
    assert {each.decided for each in short.combinations[1:]} == {"not decided"}
    assert {each.error_mps2.low for each in short.combinations} == {None}
    needed = float(short.too_short.split(" s of flight")[0].rsplit(" ", 1)[1])
    assert needed == pytest.approx(LEAST * short.block_s, abs=0.5)
