"""How a training episode is drawn and flown."""

import numpy as np
import pytest
from faultpath_quadrotor.platform import FlightSettings
from faultpath_quadrotor.training import flight
from faultpath_quadrotor.training.flight import fly
from faultpath_quadrotor.training.recorded import COMPONENTS, SIGNALS
from faultpath_quadrotor.vehicle import COLLECTIVE_MAX_N, CONTROL_RATE_HZ, RATE_LIMIT_RADPS


def signal(flights, name):
    return flights.values[[COMPONENTS.index(component) for component in SIGNALS[name]]]


def shorten(monkeypatch, steps):
    monkeypatch.setattr(flight, "EPISODE_STEPS", steps)
    monkeypatch.setattr(flight, "EPISODE_S", steps / CONTROL_RATE_HZ)


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
    keys = [("nominal", 0, 0), ("wind", 0, 0), ("nominal", 1, 0), ("nominal", 0, 1)]
    starts = [fly(pool, [episode], seed).values[:3, 0, 0] for pool, episode, seed in keys]
    assert len({tuple(start.tolist()) for start in starts}) == len(starts)


@pytest.mark.parametrize("pool", ["nominal", "wind"])
def test_commands_respect_the_vehicle_s_limits(pool):
    command = signal(fly(pool, range(32), 0), "command")[:, :-1]
    assert command[0].min() >= 0
    assert command[0].max() <= COLLECTIVE_MAX_N
    for axis, limit in enumerate(RATE_LIMIT_RADPS):
        assert np.abs(command[axis + 1]).max() <= limit


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
