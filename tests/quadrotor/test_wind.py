import numpy as np
import pytest
from faultpath_quadrotor.plant import wind
from faultpath_quadrotor.plant.wind import Winds

LEVELS = ["L0", "L1", "L2", "L3"]


def draws(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


@pytest.mark.parametrize("level", LEVELS)
def test_a_scene_s_wind_depends_on_level_and_scene_alone(level):
    alone = Winds().series(level, 7, 2.0)
    for other in (6, 8):
        assert np.array_equal(Winds().series(level, other, 2.0), alone) == (level == "L0")
    assert alone.shape == (1000, 3)
    assert alone.dtype == np.float64
    assert np.array_equal(Winds().series(level, 7, 2.0), alone)


def test_a_longer_series_begins_with_the_shorter_one():
    assert np.array_equal(Winds().series("L2", 3, 3.0)[:500], Winds().series("L2", 3, 1.0))


def test_pool_winds_belong_to_seed_and_episode():
    one = Winds().pool_series(0, 1, 0.5)
    assert np.array_equal(one, Winds().pool_series(0, 1, 0.5))
    assert not np.array_equal(one, Winds().pool_series(1, 1, 0.5))
    assert not np.array_equal(one, Winds().pool_series(0, 2, 0.5))


@pytest.mark.parametrize("rate_hz", [20, 500])
def test_turbulence_has_its_standard_deviation_from_the_first_sample(rate_hz):
    runs = np.stack([wind.dryden(draws(i), 60, rate_hz, 8.0, 4.0) for i in range(2500)])
    # 2,500 independent runs: the standard error of a deviation is 1.4 %.
    for sample in (0, 1, 30, 59):
        assert runs[:, sample].std(0) == pytest.approx([1, 1, 1], rel=0.05)
        assert runs[:, sample].mean(0) == pytest.approx([0, 0, 0], abs=0.07)


def test_turbulence_has_dryden_s_correlations():
    rate, airspeed = 100, 8.0
    runs = np.stack([wind.dryden(draws(i), 101, rate, airspeed, 4.0) for i in range(3000)])
    for lag in (5, 25, 50, 100):
        distance = airspeed * lag / rate / 4.0
        along = np.exp(-distance)
        across = (1 - distance / 2) * np.exp(-distance)
        seen = (runs[:, 0] * runs[:, lag]).mean(0)
        assert seen == pytest.approx([along, across, across], abs=0.06)
    cross = np.einsum("ri,rj->ij", runs[:, 50], runs[:, 50]) / len(runs)
    assert cross == pytest.approx(np.eye(3), abs=0.07)
