"""Windows: which states and commands they hold, and what noise may change in fits on them."""

from dataclasses import fields
from pathlib import Path

import pytest
import torch
from faultpath_quadrotor.training.fitting import fit
from faultpath_quadrotor.training.flight import collect
from faultpath_quadrotor.training.predictor_task import PredictorTask
from faultpath_quadrotor.training.windows import Windows, starts, windows_of
from faultpath_quadrotor.vehicle import CONTROL_DT_S

from faultpath.learning.model_card import Schedule


@pytest.fixture(scope="module")
def pools(tmp_path_factory):
    folder = tmp_path_factory.mktemp("data")
    return collect(folder, workers=0, episodes={"nominal": 70, "wind": 70})


@pytest.fixture(scope="module")
def nominal(pools):
    return windows_of(pools["nominal"])


@pytest.fixture(scope="module")
def windy(pools):
    return windows_of(pools["wind"])


def test_a_full_episode_has_four_windows_spread_from_end_to_end():
    assert starts(120) == [0, 29, 58, 88]


def test_command_k_acts_from_state_k_to_state_k_plus_1(nominal):
    """The motors' sum approaches the collective of command k, and of no other, with their lag.

    The sum is that of a single motor wherever none is at its limit, which is nearly everywhere.
    """
    left = torch.exp(-CONTROL_DT_S / nominal.motor_time_constant_s)

    def error(k, command):
        expected = torch.lerp(nominal.command[0, command], nominal.motor_thrust_n[k], left)
        return float((expected - nominal.motor_thrust_n[k + 1]).abs().median())

    for k in (1, 11, 12, 30):
        assert error(k, k) < 1e-4
        assert min(error(k, k - 1), error(k, k + 1)) > 0.1


def test_an_episode_is_on_one_side_of_the_split_whatever_the_others(nominal, windy):
    both = Windows.join([nominal, windy])
    training, validation = both.split(0.3)
    episodes = [{name.rpartition("/")[0] for name in part.ids} for part in (training, validation)]
    assert not episodes[0] & episodes[1]
    assert len(training) + len(validation) == len(both)
    assert len(episodes[1]) == pytest.approx(0.3 * 140, abs=17)
    _, fewer = windy.take(torch.arange(20)).split(0.3)
    assert set(fewer.ids) == set(validation.ids) & set(windy.ids[:20])


def test_take_and_join_keep_windows_whole(nominal, windy):
    both = Windows.join([nominal, windy])
    index = torch.tensor([len(nominal) + 3, 1])
    picked = both.take(index)
    assert picked.ids == (windy.ids[3], nominal.ids[1])
    for field in fields(Windows)[:-1]:
        tensor = getattr(picked, field.name)
        assert torch.equal(tensor[..., 0], getattr(windy, field.name)[..., 3])
        assert torch.equal(tensor[..., 1], getattr(nominal, field.name)[..., 1])


@pytest.fixture(scope="module")
def data(pools) -> Path:
    return pools["nominal"].parent


def task(name, data, seed=0, epochs=2, **options):
    short = PredictorTask(name, seed, data, **options)
    short.schedule = Schedule(epochs=epochs, batch_size=64)
    return short


@pytest.mark.parametrize("base", ["wm-a", "wm-u"])
def test_zero_noise_is_the_baseline_to_the_bit(base, data, tmp_path):
    """+DCC changes the delivered calibration and nothing else: not weights, not order."""
    plain = fit(task(base, data), tmp_path)
    silent = fit(task(f"{base}+dcc", data, half_range=0.0), tmp_path)
    noisy = fit(task(f"{base}+dcc", data), tmp_path / "noisy")
    assert silent.read_bytes() == plain.read_bytes()
    assert noisy.read_bytes() != plain.read_bytes()


def test_noise_reaches_every_place_with_one_draw_a_window(data):
    noisy = task("wm-u+dcc", data)
    noisy.load()
    taps = noisy._delivered
    mass = [value for (channel, _), value in taps.items() if channel == "mass"]
    for place in ("history", "normalise_thrust", "features"):
        assert ("mass", f"predictor.{place}") in taps
    assert all(torch.equal(value, mass[0]) for value in mass)
    noisy.begin_epoch(1)
    assert torch.equal(noisy._delivered["mass", "predictor.history"], mass[0])
