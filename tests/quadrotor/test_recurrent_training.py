"""How the wind reconstruction is fitted, and that its repair differs by the corruption alone."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
import torch
from faultpath_quadrotor.training import corruption
from faultpath_quadrotor.training.corruption import dcc
from faultpath_quadrotor.training.flight import fly
from faultpath_quadrotor.training.reconstruction_task import HEAD, MODELS, ReconstructionTask
from faultpath_quadrotor.training.windows import Windows, cut
from flights import in_memory

from faultpath.core.errors import UserError

COUNT = 96


@cache
def windows(seed=0):
    return cut(in_memory(fly("wind", range(32), seed))).take(torch.arange(COUNT))


def task(name, seed=0):
    made = ReconstructionTask(name, seed, Path("nowhere"))
    made.use(windows(), windows(seed=1))
    return made


def loss(made):
    return made.loss(made.module(), torch.arange(COUNT)).detach()


def weights(made):
    return torch.cat([value.flatten() for value in made.module().state_dict().values()])


def test_repair_shares_weights_and_order_and_without_noise_the_loss(monkeypatch):
    plain, repair = task("gru"), task("gru+dcc")
    assert torch.equal(weights(plain), weights(repair))
    assert plain.order_key == repair.order_key
    noiseless = MODELS | {"gru+dcc": replace(MODELS["gru+dcc"], half_range=0.0)}
    monkeypatch.setattr("faultpath_quadrotor.training.reconstruction_task.MODELS", noiseless)
    assert loss(plain) == loss(task("gru+dcc"))


def test_noise_reaches_the_loss_and_is_drawn_once_for_the_whole_fit():
    made = task("gru+dcc")
    assert loss(made) != loss(task("gru"))
    first = loss(made)
    made.begin_epoch(1)
    assert loss(made) == first
    assert not torch.equal(made._supplied, task("gru+dcc", seed=1)._supplied)


def test_loss_reads_no_future_state_command_or_wind():
    plain, other = windows(), windows(seed=5)

    def mixed(name, time, keep):
        mine, theirs = getattr(plain, name), getattr(other, name)
        later = theirs.narrow(time, keep, mine.shape[time] - keep)
        return torch.cat([mine.narrow(time, 0, keep), later], time)

    future = {name: mixed(name, 1, 13) for name in ("position", "velocity", "rate", "wind_mps")}
    future["rotation"] = mixed("rotation", 2, 13)
    future["command"] = mixed("command", 1, 12)
    made, changed = task("gru"), task("gru")
    changed.use(Windows(**{**vars(plain), **future}), windows(seed=1))
    assert torch.equal(weights(made), weights(changed))
    assert loss(made) == loss(changed)


def corrupted(faults, readers=(HEAD,), count=COUNT):
    readings = {"mass": torch.full((count,), 1.5), "thrust_scale": torch.full((count,), 0.8)}
    ids = tuple(f"wind/{i:05d}/0" for i in range(count))
    return readings, corruption.corrupted(faults, readers, ids, 0, readings)


def test_mass_and_thrust_scale_err_independently_within_the_half_range():
    readings, delivered = corrupted(dcc([HEAD]), count=2000)
    mass, scale = (delivered[c, HEAD] / readings[c] - 1 for c in ("mass", "thrust_scale"))
    for factor in (mass, scale):
        assert factor.abs().max() <= 0.2 + 1e-6
        assert factor.std() == pytest.approx(0.2 / 3**0.5, rel=0.05)
    assert abs(float(torch.corrcoef(torch.stack((mass, scale)))[0, 1])) < 0.08


def test_readers_of_one_channel_share_the_draw_and_others_are_left_alone():
    places = ("predictor.dynamics", "predictor.trim", "predictor.wind_map")
    readings, delivered = corrupted(dcc(places[:2]), readers=places)
    assert torch.equal(delivered["mass", places[0]], delivered["mass", places[1]])
    assert not torch.equal(delivered["mass", places[0]], readings["mass"])
    assert delivered["mass", places[2]] is readings["mass"]
    assert ("thrust_scale", places[2]) not in delivered  # the wind map reads the mass alone
    with pytest.raises(UserError, match="reaches no reader"):
        corrupted(dcc(["predictor.trim"]))
