"""The disturbance observer: its identity, its detail, and what calibration does to it."""

import pytest
import torch
from faultpath_quadrotor import so3
from faultpath_quadrotor.predictors.kinematic import LinearDrag
from faultpath_quadrotor.reconstruction import DisturbanceObserver
from faultpath_quadrotor.vehicle import CONTROL_DT_S, NOMINAL_DRAG_KGPS

LANES = 32


def delivered(seed, velocity=None, mass=1.0, scale=1.0, map_mass=None):
    draw = torch.Generator().manual_seed(seed)
    one = torch.ones(LANES, dtype=torch.float64)

    def normal(*shape):
        return torch.randn(*shape, LANES, generator=draw, dtype=torch.float64)

    thrust = 9.81 + normal(1)
    return {
        ("velocity", "velocity_difference"): normal(3) if velocity is None else velocity,
        ("attitude", "nominal_model"): so3.exp(0.4 * normal(3)),
        ("action", "nominal_model"): torch.cat([thrust, normal(3)]),
        ("mass", "nominal_model"): mass * one,
        ("thrust_scale", "nominal_model"): scale * one,
        ("mass", "wind_map"): (mass if map_mass is None else map_mass) * one,
    }


@pytest.mark.parametrize(("mass", "scale"), [(1.0, 1.0), (1.1, 0.9), (0.9, 1.1)])
def test_unfiltered_estimate_recombines_to_the_observed_acceleration(mass, scale):
    """a_0 + B w_raw = a_obs whatever the calibration (paper, Eq. 2)."""
    observer = DisturbanceObserver(low_pass=1.0, drag_kgps=NOMINAL_DRAG_KGPS)
    first, second = (delivered(seed, mass=mass, scale=scale) for seed in (1, 2))
    wind = observer.wind(observer.update(observer.begin(first), second))
    pushed = LinearDrag(NOMINAL_DRAG_KGPS).force(second["attitude", "nominal_model"], wind) / mass
    read = ("velocity", "velocity_difference")
    observed = (second[read] - first[read]) / CONTROL_DT_S
    torch.testing.assert_close(observer.nominal(second) + pushed, observed)
