"""The plant against MuJoCo: same commands and winds, same trajectories."""

import numpy as np
import pytest
import torch

from faultpath.quadrotor import so3, wind
from faultpath.quadrotor.plant import TorchPlant
from faultpath.quadrotor.state import State
from faultpath.quadrotor.vehicle import STEPS_PER_CONTROL, draw
from faultpath.quadrotor.vehicle_batch import Vehicle

mujoco_check = pytest.importorskip("faultpath.quadrotor.plant.mujoco_check")

LANES, CONTROLS = 4, 30
PARTS = ("position", "velocity", "rotation", "rate")
# Over 1.5 s of hard manoeuvres, after extrapolating MuJoCo's first-order steps to zero:
TOLERANCE = {"position": 2e-4, "velocity": 4e-4, "rotation": 1e-4, "rate": 4e-4}


def winds(kind: str) -> np.ndarray:
    steps = CONTROLS * STEPS_PER_CONTROL
    if kind == "varying":
        series = [wind.pool_series(1, lane, steps / 500) for lane in range(LANES)]
        return np.stack(series, axis=-1)
    constant = np.random.default_rng(9).normal(scale=4, size=(3, LANES))
    return np.broadcast_to(constant, (steps, 3, LANES)).copy()


def fly_mujoco(parameters, start: State, commands, flow, substeps: int) -> dict[str, np.ndarray]:
    ends = []
    for lane in range(LANES):
        parts = [getattr(start, name)[..., lane].numpy() for name in PARTS]
        vehicle = mujoco_check.MujocoPlant(parameters[lane], *parts, substeps=substeps)
        for k in range(CONTROLS):
            at = slice(k * STEPS_PER_CONTROL, (k + 1) * STEPS_PER_CONTROL)
            vehicle.advance(commands[k, :, lane], flow[at, :, lane])
        ends.append([getattr(vehicle, name) for name in PARTS])
    return {name: np.stack([end[i] for end in ends], axis=-1) for i, name in enumerate(PARTS)}


@pytest.mark.parametrize("kind", ["constant", "varying"])
def test_trajectories_agree(kind):
    generator = np.random.default_rng(17)
    parameters = [draw(generator) for _ in range(LANES)]
    vehicle = Vehicle.stack(parameters)
    position, velocity, turn, rate = torch.from_numpy(generator.normal(size=(4, 3, LANES)))
    start = State(position, 2 * velocity, so3.exp(turn), rate)
    hover = vehicle.hover_command().numpy()
    commands = hover * generator.uniform(0.3, 1.8, (CONTROLS, 1, LANES))
    commands[:, 1:] = generator.uniform(-1, 1, (CONTROLS, 3, LANES)) * [[3.5], [3.5], [2.0]]
    flow = winds(kind)

    plant = TorchPlant(vehicle)
    now = plant.start(start)
    for k in range(CONTROLS):
        at = slice(k * STEPS_PER_CONTROL, (k + 1) * STEPS_PER_CONTROL)
        now = plant.advance(now, torch.from_numpy(commands[k]), torch.from_numpy(flow[at]))

    coarse, fine = (fly_mujoco(parameters, start, commands, flow, n) for n in (4, 8))
    moved = (now.state.position - start.position).norm(dim=0)
    assert moved.min() > 1.0
    for name in PARTS:
        extrapolated = 2 * fine[name] - coarse[name]
        error = np.abs(extrapolated - getattr(now.state, name).numpy()).max()
        assert error < TOLERANCE[name], (name, error)
