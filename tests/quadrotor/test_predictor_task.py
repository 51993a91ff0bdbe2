"""Fitting of predictors: what calibration noise may change, and what a window tells a model."""

from pathlib import Path

import pytest
import torch
from faultpath_quadrotor.training.collection import collect
from faultpath_quadrotor.training.fitting import fit
from faultpath_quadrotor.training.predictor_task import PredictorTask

from faultpath.learning.model_card import Schedule

EPISODES = {"nominal": 70, "wind": 70}


@pytest.fixture(scope="module")
def data(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("data")
    collect(folder, workers=0, episodes=EPISODES)
    return folder


def task(name, data, seed=0, epochs=2, **options):
    short = PredictorTask(name, seed, data, **options)
    short.schedule = Schedule(epochs=epochs, batch_size=64)
    return short


def loaded(name, data, **options):
    ready = task(name, data, **options)
    ready.load()
    return ready


@pytest.mark.parametrize("base", ["wm-a", "wm-u"])
def test_zero_noise_is_the_baseline_to_the_bit(base, data, tmp_path):
    """+DCC changes the delivered calibration and nothing else: not weights, not order."""
    plain = fit(task(base, data), tmp_path)
    silent = fit(task(f"{base}+dcc", data, half_range=0.0), tmp_path)
    noisy = fit(task(f"{base}+dcc", data), tmp_path / "noisy")
    assert silent.read_bytes() == plain.read_bytes()
    assert noisy.read_bytes() != plain.read_bytes()


def test_noise_reaches_every_place_with_one_draw_a_window(data):
    noisy = loaded("wm-u+dcc", data)
    taps = noisy._delivered
    mass = [value for (channel, _), value in taps.items() if channel == "mass"]
    scale = [value for (channel, _), value in taps.items() if channel == "thrust_scale"]
    assert {place for channel, place in taps if channel == "mass"} >= {
        "predictor.history",
        "predictor.normalise_thrust",
        "predictor.features",
    }
    assert all(torch.equal(value, mass[0]) for value in mass)
    off = mass[0] / noisy._train.mass_kg - 1
    other = scale[0] / noisy._train.thrust_scale - 1
    assert off.abs().max() <= 0.2
    assert off.std() == pytest.approx(0.2 / 3**0.5, rel=0.2)
    assert torch.corrcoef(torch.stack([off, other]))[0, 1].abs() < 0.35
    noisy.begin_epoch(1)
    assert torch.equal(noisy._delivered["mass", "predictor.history"], mass[0])
