import numpy as np
import pytest
from faultpath_quadrotor.plant import wind
from faultpath_quadrotor.plant.wind import Winds


def draws(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


@pytest.mark.parametrize("level", ["L0", "L1", "L2", "L3"])
def test_a_scene_s_wind_depends_on_level_and_scene_alone(level):
    alone = Winds().series(level, 7, 2.0)
    assert alone.shape == (1000, 3)
    for other in (6, 8):
        assert np.array_equal(Winds().series(level, other, 2.0), alone) == (level == "L0")
    assert np.array_equal(Winds().series(level, 7, 1.0), alone[:500]), "longer ones begin alike"


def test_pool_winds_belong_to_seed_and_episode():
    keys = (0, 1), (0, 1), (1, 1), (0, 2)
    one, same, *others = (Winds().pool_series(*key, 0.5) for key in keys)
    assert np.array_equal(one, same)
    assert not any(np.array_equal(one, other) for other in others)


def test_turbulence_has_dryden_s_deviations_and_correlations_from_the_first_sample():
    rate, airspeed = 100, 8.0
    # Of 3,000 independent runs: the standard error of a deviation is 1.3 %.
    runs = np.stack([wind.dryden(draws(i), 101, rate, airspeed, 4.0) for i in range(3000)])
    for sample in (0, 1, 30, 100):
        assert runs[:, sample].std(0) == pytest.approx([1, 1, 1], rel=0.05)
        assert runs[:, sample].mean(0) == pytest.approx([0, 0, 0], abs=0.07)
    for lag in (5, 25, 50, 100):
        distance = airspeed * lag / rate / 4.0
        along = np.exp(-distance)
        across = (1 - distance / 2) * np.exp(-distance)
        seen = (runs[:, 0] * runs[:, lag]).mean(0)
        assert seen == pytest.approx([along, across, across], abs=0.06)
    cross = np.einsum("ri,rj->ij", runs[:, 50], runs[:, 50]) / len(runs)
    assert cross == pytest.approx(np.eye(3), abs=0.07)
