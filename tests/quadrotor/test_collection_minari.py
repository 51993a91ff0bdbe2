"""The export to Minari, against a stand-in with the interface of Minari's own."""

import sys
from dataclasses import dataclass
from types import ModuleType

import numpy as np
import pytest

from faultpath.errors import UserError
from faultpath.quadrotor.training import flight
from faultpath.quadrotor.training.collection import collect
from faultpath.quadrotor.training.minari_export import export_minari
from faultpath.quadrotor.training.pool import read_pool


@dataclass(frozen=True)
class EpisodeBuffer:
    options: dict
    observations: np.ndarray
    actions: np.ndarray
    rewards: np.ndarray
    terminations: np.ndarray
    truncations: np.ndarray
    infos: dict


class Box:
    def __init__(self, low, high, shape=None, dtype=np.float32):
        self.low, self.high = low, high
        self.shape = shape or np.shape(low)


@pytest.fixture
def made(monkeypatch):
    """A stand-in for Minari; what it is asked to make lands in the dictionary."""
    made = {}

    def create_dataset_from_buffers(dataset_id, buffer, **rest):
        if dataset_id in made:
            raise ValueError("it exists already")
        made[dataset_id] = (buffer, rest)

    minari, collector = ModuleType("minari"), ModuleType("minari.data_collector")
    gymnasium, spaces = ModuleType("gymnasium"), ModuleType("gymnasium.spaces")
    monkeypatch.setattr(minari, "create_dataset_from_buffers", create_dataset_from_buffers, False)
    monkeypatch.setattr(collector, "EpisodeBuffer", EpisodeBuffer, False)
    monkeypatch.setattr(spaces, "Box", Box, False)
    for module in (minari, collector, gymnasium, spaces):
        monkeypatch.setitem(sys.modules, module.__name__, module)
    return made


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(flight, "EPISODE_STEPS", 10)
        patch.setattr(flight, "EPISODE_S", 0.5)
        yield collect(tmp_path_factory.mktemp("data"), ("wind",), 0, {"wind": 4})["wind"]


def test_every_episode_is_exported_with_its_states_commands_and_vehicle(path, made):
    assert export_minari(path, "faultpath/wind-v0") == 4
    buffer, rest = made["faultpath/wind-v0"]
    pool = read_pool(path)
    assert rest["observation_space"].shape == (18,)
    assert rest["action_space"].high.tolist() == [46.0, 6.0, 6.0, 3.0]
    assert rest["action_space"].low.tolist() == [0.0, -6.0, -6.0, -3.0]
    for episode, exported in enumerate(buffer):
        steps, first = pool.steps[episode], pool.first_row[episode]
        rows = pool.values[:, first : first + steps + 1].T
        assert np.array_equal(exported.observations, rows[:, :18])
        assert np.array_equal(exported.actions, rows[:-1, 18:22])
        assert np.array_equal(exported.infos["wind_mps"], rows[:, 22:25])
        assert np.isfinite(exported.actions).all()
        assert exported.options["vehicle"]["mass_kg"] == pool.vehicles["mass_kg"][episode]
        assert exported.truncations.sum() + exported.terminations.sum() == 1
        assert exported.terminations[-1] == (steps < 120)


def test_what_minari_refuses_is_told(path, made):
    export_minari(path, "faultpath/wind-v0")
    with pytest.raises(UserError, match="refused the dataset 'faultpath/wind-v0'"):
        export_minari(path, "faultpath/wind-v0")


def test_without_minari_the_extra_is_named(path, monkeypatch):
    monkeypatch.setitem(sys.modules, "minari", None)
    with pytest.raises(UserError, match="extra 'minari'"):
        export_minari(path, "faultpath/wind-v0")
