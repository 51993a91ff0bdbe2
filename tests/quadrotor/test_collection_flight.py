"""How a training episode is drawn and flown."""

import numpy as np
import pytest
import torch
from faultpath_quadrotor.platform import (
    ControllerSettings,
    FlightSettings,
    PerturbationSettings,
)
from faultpath_quadrotor.training import flight
from faultpath_quadrotor.training.flight import EPISODE_STEPS, fly
from faultpath_quadrotor.training.recorded import COMPONENTS, SIGNALS
from faultpath_quadrotor.vehicle import (
    COLLECTIVE_MAX_N,
    CONTROL_RATE_HZ,
    GRAVITY_MPS2,
    RATE_LIMIT_RADPS,
)

torch.set_num_threads(1)
COUNT = 192


def signal(flights, name):
    return flights.values[[COMPONENTS.index(component) for component in SIGNALS[name]]]


def shorten(monkeypatch, steps):
    monkeypatch.setattr(flight, "EPISODE_STEPS", steps)
    monkeypatch.setattr(flight, "EPISODE_S", steps / CONTROL_RATE_HZ)


def within(flights):
    """Which control instants [N + 1, B] belong to an episode."""
    return np.arange(EPISODE_STEPS + 1)[:, None] <= flights.steps


@pytest.fixture(scope="module", params=["nominal", "wind"])
def flights(request):
    return fly(request.param, range(COUNT), 0)


@pytest.mark.parametrize("pool", ["nominal", "wind"])
def test_an_episode_is_the_same_in_any_batch_to_the_bit(pool, monkeypatch):
    shorten(monkeypatch, 40)
    together = fly(pool, range(45), 3)
    for company in ([7], [40, 7, 0], list(range(7, 72))):
        other = fly(pool, company, 3)
        lane = company.index(7)
        assert np.array_equal(together.values[..., 7], other.values[..., lane], equal_nan=True)
        assert together.steps[7] == other.steps[lane]
        assert together.vehicles[7] == other.vehicles[lane]


def test_episodes_belong_to_pool_number_and_seed(monkeypatch):
    shorten(monkeypatch, 2)
    starts = [
        fly(pool, [episode], seed).values[:3, 0, 0].tolist()
        for pool, episode, seed in (
            ("nominal", 0, 0),
            ("wind", 0, 0),
            ("nominal", 1, 0),
            ("nominal", 0, 1),
        )
    ]
    assert len({tuple(start) for start in starts}) == len(starts)


def test_commands_respect_the_vehicle_s_limits(flights):
    command = signal(flights, "command")[:, :-1]
    assert command[0].min() >= 0
    assert command[0].max() <= COLLECTIVE_MAX_N
    for axis, limit in enumerate(RATE_LIMIT_RADPS):
        assert np.abs(command[axis + 1]).max() <= limit


def test_nearly_all_episodes_last_and_what_is_kept_had_not_diverged(flights):
    settings = FlightSettings()
    assert (flights.steps == EPISODE_STEPS).mean() > 0.93
    inside = within(flights)
    inside[0] = False  # the start is not asked
    speed = np.linalg.norm(signal(flights, "velocity"), axis=0)[inside]
    assert speed.max() < settings.speed_limit_mps
    lowest = np.cos(np.radians(settings.tilt_limit_deg))
    assert signal(flights, "rotation")[8][inside].min() > lowest - 1e-6
    for place, (low, high) in zip(signal(flights, "position"), settings.volume_m, strict=True):
        assert low < place[inside].min()
        assert place[inside].max() < high


def test_an_episode_ends_with_its_last_state_in_bounds(monkeypatch):
    shorten(monkeypatch, 40)
    tight = FlightSettings(tilt_limit_deg=35.0)
    flights = fly("nominal", range(64), 0, tight)
    short = np.flatnonzero(flights.steps < 40)
    assert len(short) > 10
    up = signal(flights, "rotation")[8]
    for lane in short:
        beyond = np.flatnonzero(up[1:, lane] <= np.cos(np.radians(35.0)))
        assert flights.steps[lane] == beyond[0]


def test_an_undisturbed_vehicle_comes_to_rest_at_its_last_waypoint_on_its_hover_thrust():
    calm = PerturbationSettings(clean_share=1.0, clean_strength=0.0, pulses_per_s=0.0)
    settings = FlightSettings(controller=ControllerSettings(waypoints=1), perturbation=calm)
    flights = fly("nominal", range(64), 0, settings)
    hover = np.array([v.mass_kg * GRAVITY_MPS2 / v.thrust_scale for v in flights.vehicles])
    assert (flights.steps == EPISODE_STEPS).all()
    at_rest = np.linalg.norm(signal(flights, "velocity")[:, -1], axis=0) < 0.3
    hovering = np.abs(signal(flights, "command")[0, -2] / hover - 1) < 0.03
    spinning = np.abs(signal(flights, "motor_thrust_n")[0, -1] / hover - 1) < 0.03
    # A few vehicles have so little torque and such slow motors that they never quite settle.
    assert (at_rest & hovering & spinning).mean() > 0.95
    end = signal(flights, "position")[:, -1]
    for axis, (low, high) in enumerate(settings.controller.arena_m):
        assert low - 0.3 < end[axis].min()
        assert end[axis].max() < high + 0.3
