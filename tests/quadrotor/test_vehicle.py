import numpy as np
import pytest
from faultpath_quadrotor.vehicle import VehicleParameters, VehicleRanges, draw
from pydantic import ValidationError

DRAWS = [draw(np.random.default_rng(seed)) for seed in range(400)]


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("mass_kg", 0.5, 1.5),
        ("thrust_scale", 0.5, 1.5),
        ("torque_scale", 0.5, 1.5),
        ("motor_time_constant_s", 0.02, 0.08),
        ("drag_kgps", 0.1, 0.5),
    ],
)
def test_draws_fill_their_range_and_stay_within(name, low, high):
    values = np.array([getattr(p, name) for p in DRAWS])
    margin = 0.03 * (high - low)
    assert low <= values.min() < low + margin
    assert high - margin < values.max() <= high
    assert abs(values.mean() - (low + high) / 2) < 2 * margin


def test_weak_vehicles_are_rejected():
    wide = VehicleRanges(mass=0.8, thrust_scale=0.9)
    ratios = [draw(np.random.default_rng(seed), wide).thrust_to_weight for seed in range(200)]
    assert 1.5 <= min(ratios) < 2.0


@pytest.mark.parametrize("wrong", [{"mass_kg": 0.0}, {"mass_kg": float("nan")}])
def test_impossible_parameters_are_refused(wrong):
    with pytest.raises(ValidationError):
        VehicleParameters(**wrong)
