"""The plant on MuJoCo: the reference plant's trajectories, and the laws that every plant keeps."""

import runpy
from pathlib import Path

import numpy as np
import pytest
import torch
from faultpath_quadrotor.plant import Plant, PlantState, TorchPlant
from faultpath_quadrotor.plant.module import World
from faultpath_quadrotor.plant.wind import Winds
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.vehicle import STEPS_PER_CONTROL
from flights import bits as outcome_bits
from flights import fly as fly_trials
from flights import quadrotor, tumbling
from test_plant import drawn_vehicles, moving
from torch import Tensor

pytest.importorskip("mujoco")
EXAMPLE = Path(__file__).parents[2] / "examples" / "mujoco_plant.py"
MujocoPlant = runpy.run_path(str(EXAMPLE))["MujocoPlant"]

F64 = torch.float64
LANES, CONTROLS = 40, 30
# Over 1.5 s of hard manoeuvres. MuJoCo's steps are of fourth order: this is the reference's error.
TOLERANCE = {"position": 2e-4, "velocity": 4e-4, "rotation": 1e-4, "rate": 4e-4}


def manoeuvres() -> Tensor:
    """Commands of each control step, `[CONTROLS, 4, LANES]`, some beyond what motors can give."""
    stream = torch.Generator().manual_seed(18)
    drawn = torch.rand(CONTROLS, 4, LANES, dtype=F64, generator=stream)
    hover = drawn_vehicles(LANES).hover_command()[0]
    thrust = hover * (0.3 + 1.5 * drawn[:, :1])
    spread = torch.tensor([3.5, 3.5, 2.0], dtype=F64)[:, None]
    return torch.cat((thrust, (2 * drawn[:, 1:] - 1) * spread), dim=1)


def blowing() -> Tensor:
    seconds = CONTROLS * STEPS_PER_CONTROL / 500
    series = [Winds().pool_series(1, lane, seconds) for lane in range(LANES)]
    return torch.from_numpy(np.stack(series, axis=-1)).double()


def fly(plant: Plant, now: PlantState, commands: Tensor, winds: Tensor) -> PlantState:
    for command, block in zip(commands, winds.split(STEPS_PER_CONTROL), strict=True):
        now = plant.advance(now, command, block)
    return now


def test_both_plants_fly_the_same_trajectories() -> None:
    vehicle, start = drawn_vehicles(LANES), moving(LANES, 17)
    plants = (TorchPlant(vehicle), MujocoPlant(vehicle))
    theirs, ours = (fly(p, p.start(start), manoeuvres(), blowing()) for p in plants)
    assert (theirs.state.position - start.position).norm(dim=0).min() > 1.0
    for name, tolerance in TOLERANCE.items():
        error = (getattr(ours.state, name) - getattr(theirs.state, name)).abs().max()
        assert error < tolerance, (name, error)
    assert (ours.thrusts - theirs.thrusts).abs().max() < 1e-4


SCENES = load_library("selection").scenes[:34]


def test_trials_end_alike_on_both_and_are_told_apart() -> None:
    worlds = [World(SCENES, "L2", False, plant=plant) for plant in (TorchPlant, MujocoPlant)]
    for world in worlds:
        for command in tumbling(22, 64):
            world.advance(command)
    theirs, ours = (world.progress for world in worlds)
    crashed = theirs.crashed[: len(SCENES)].sum()
    assert 5 < crashed < len(SCENES) - 5, "some end, some fly on"
    assert torch.equal(ours.crashed, theirs.crashed)
    assert torch.equal(ours.time_s, theirs.time_s)
    assert (ours.min_clearance_m - theirs.min_clearance_m).abs().max() < 1e-3


@pytest.mark.usefixtures("short")
def test_an_audit_s_trials_are_their_own_and_of_their_plant() -> None:
    scenes = [scene.id for scene in SCENES[:4]]
    system, other = (quadrotor(wind="L3", plant=plant) for plant in (f"{EXAMPLE}:create", "torch"))
    flights = ((system, scenes), (system, scenes[2:3]), (other, scenes))
    whole, alone, torch_s = (fly_trials(each, "dob", some, seed=3)[0] for each, some in flights)
    assert outcome_bits(alone[0]) == outcome_bits(whole[2])
    for ours, theirs in zip(whole, torch_s, strict=True):
        assert ours.initial_hash != theirs.initial_hash
        assert ours.disturbance_hash == theirs.disturbance_hash
        near, far = (each.metrics["terminal_distance_m"] for each in (ours, theirs))
        assert near == pytest.approx(far, abs=1e-3)
    assert system.fingerprint() != other.fingerprint()
    assert system.backend.endswith("mujoco_plant.py:create")
