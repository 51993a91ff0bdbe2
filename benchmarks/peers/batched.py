"""WM-A as a user of a batch-first library writes it: torch.nn layers over states `[K, 50]`.

A state is position 3, velocity 3, rotation 9 (by rows), body rate 3 and latent 32. The inputs'
standardisation is folded into the first layers, so that no time goes into it.

python -m benchmarks.peers.batched FILE.npz   writes the problem for a peer without torch
"""

import math
import sys

import numpy as np
import torch
from faultpath_quadrotor.planners import CostWeights, SamplerSettings
from faultpath_quadrotor.predictors import anchored
from faultpath_quadrotor.predictors.kinematic import RATE_LAG_S
from faultpath_quadrotor.predictors.network import LATENT, Affine, LatentNetwork
from faultpath_quadrotor.vehicle import CONTROL_DT_S, GRAVITY_MPS2, RATE_LIMIT_RADPS
from torch import Tensor, nn

from benchmarks import planning

STATE = 18 + LATENT
POSITION, VELOCITY, ROTATION, RATE, CODE = (
    slice(0, 3),
    slice(3, 6),
    slice(6, 15),
    slice(15, 18),
    slice(18, STATE),
)
KEEP = math.exp(-CONTROL_DT_S / RATE_LAG_S)
MEAN = RATE_LAG_S / CONTROL_DT_S * (1 - KEEP)


def linear(layer: Affine, *, over: tuple[Tensor, Tensor] | None = None, at: int = 0) -> nn.Linear:
    """Return a layer; with mean and deviation `over`, its inputs from `at` on are taken raw."""
    weight, bias = layer.weight.detach().clone(), layer.bias.detach().flatten()
    if over is not None:
        mean, deviation = over
        weight[:, at:] /= deviation.T
        bias = bias - weight[:, at:] @ mean[:, 0]
    folded = nn.Linear(weight.shape[1], weight.shape[0])
    folded.load_state_dict({"weight": weight, "bias": bias})
    return folded


class BatchModel(nn.Module):
    """One step of WM-A, for one scene."""

    constant: Tensor
    """Acceleration by wind and gravity, `[3]`, m/s^2."""
    eye: Tensor

    def __init__(self) -> None:
        super().__init__()
        network: LatentNetwork = planning.model().network
        mean, std = network.feature_mean, network.feature_std
        self.embed = linear(network.embed, over=(mean[15:19], std[15:19]))
        self.cell = nn.GRUCell(16, LATENT)
        from_input, from_latent = network.cell.from_input, network.cell.from_latent
        self.cell.load_state_dict(
            {
                "weight_ih": from_input.weight,
                "weight_hh": from_latent.weight,
                "bias_ih": from_input.bias[:, 0],
                "bias_hh": from_latent.bias[:, 0],
            }
        )
        first = linear(network.first, over=(mean, std), at=LATENT)
        second, last = linear(network.second), linear(network.last)
        self.head = nn.Sequential(first, nn.ReLU(), second, nn.ReLU(), last)
        readings = planning.inputs()
        mass_kg = readings["mass", "dynamics"]
        self.gain = float(readings["thrust_scale", "dynamics"] / mass_kg)
        self.weight_n = float(readings["mass", "normalise_thrust"]) * GRAVITY_MPS2
        constant = planning.DRAG_KGPS * readings["wind", "wind_map"][:, 0, 0] / mass_kg[0]
        constant[2] -= GRAVITY_MPS2
        self.register_buffer("constant", constant)
        self.register_buffer("eye", torch.eye(3))

    def forward(self, state: Tensor, command: Tensor) -> Tensor:
        """Return the states `[K, 50]` after one interval under `command` `[K, 4]`."""
        rotation, rate = state[:, ROTATION].view(-1, 3, 3), state[:, RATE]
        action = torch.cat((command[:, :1] / self.weight_n, command[:, 1:]), 1)
        latent = self.cell(torch.relu(self.embed(action)), state[:, CODE])
        residual = torch.tanh(self.head(torch.cat((latent, state[:, 3:18], action), 1)))
        linear = residual[:, :3] * anchored.LINEAR_BOUND_MPS2
        angular = residual[:, 3:] * anchored.ANGULAR_BOUND_RADPS2

        dt, target = CONTROL_DT_S, command[:, 1:]
        lag = rate - target
        turn = (target + MEAN * lag) * dt + (0.5 * dt * dt) * angular
        ahead = torch.bmm(rotation, self.exponential(turn))
        thrust = (0.5 * self.gain) * command[:, :1]
        acceleration = (rotation[:, :, 2] + ahead[:, :, 2]) * thrust + self.constant + linear
        velocity = state[:, VELOCITY] + dt * acceleration
        position = state[:, POSITION] + (0.5 * dt) * (state[:, VELOCITY] + velocity)
        after = target + KEEP * lag + dt * angular
        return torch.cat((position, velocity, ahead.flatten(1), after, latent), 1)

    def exponential(self, turn: Tensor) -> Tensor:
        """Return the rotations `[K, 3, 3]` by `turn` `[K, 3]`, rad."""
        angle = torch.linalg.vector_norm(turn, dim=1).clamp_min(1e-9)[:, None, None]
        x, y, z = (turn / angle[:, 0]).unbind(1)
        o = torch.zeros_like(x)
        cross = torch.stack((o, -z, y, z, o, -x, -y, x, o), 1).view(-1, 3, 3)
        return self.eye + angle.sin() * cross + (1 - angle.cos()) * torch.bmm(cross, cross)


def initial() -> Tensor:
    readings = planning.inputs()
    state = readings.state
    code = readings["history_code", "latent"]
    parts = (state.position, state.velocity, state.rotation.flatten(0, 1), state.rate, code)
    return torch.cat([part.reshape(-1) for part in parts])


@torch.inference_mode()
def positions(step: BatchModel) -> list[float]:
    """Return the positions `[3, H, 32]` under the problem's candidates, m."""
    state = initial().expand(planning.CHECKED, -1)
    path = []
    for command in planning.commands()[:, :, 0, : planning.CHECKED]:
        state = step(state, command.T)
        path.append(state[:, POSITION].T)
    return torch.stack(path, 1).flatten().tolist()


def actions() -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Return centre, spread and bounds of the planner's commands, `[4]` each."""
    hover = float(planning.inputs().hover_thrust)
    sampler = SamplerSettings()
    centre = torch.tensor([hover, 0.0, 0.0, 0.0])
    sigma = torch.tensor([sampler.thrust_sigma * hover, *sampler.rate_sigma_radps])
    high = torch.tensor([2 * hover, *RATE_LIMIT_RADPS])
    return centre, sigma, torch.cat((torch.zeros(1), -high[1:])), high


_GOAL = torch.tensor(planning.GOAL_M)
WEIGHTS = CostWeights()


def cost(state: Tensor) -> Tensor:
    """Return the distance to the goal and the penalty on speed of states `[..., 50]`."""
    away = torch.linalg.vector_norm(state[..., POSITION] - _GOAL, dim=-1)
    speed = torch.linalg.vector_norm(state[..., VELOCITY], dim=-1)
    return away + WEIGHTS.speed * (speed - WEIGHTS.v_max_mps).clamp_min(0).square()


def write_problem(path: str) -> None:
    """Write weights, constants, state, actions, and the positions of some candidates."""
    model = BatchModel()
    arrays = {name: weight.numpy() for name, weight in model.state_dict().items()}
    bounds = dict(zip(("centre", "sigma", "low", "high"), actions(), strict=True))
    arrays |= {name: bound.numpy() for name, bound in bounds.items()}
    candidates = planning.commands()[:, :, 0, : planning.CHECKED].permute(0, 2, 1)
    shape = (3, planning.HORIZON, planning.CHECKED)
    np.savez(
        path,
        initial=initial().numpy(),
        candidates=candidates.numpy(),
        positions=np.reshape(planning.positions(), shape),
        sizes=(planning.CANDIDATES, planning.HORIZON),
        motion=(model.gain, model.weight_n, KEEP, MEAN, CONTROL_DT_S),
        bounds=(anchored.LINEAR_BOUND_MPS2, anchored.ANGULAR_BOUND_RADPS2),
        goal=planning.GOAL_M,
        speed=(WEIGHTS.speed, WEIGHTS.v_max_mps),
        **arrays,
    )


if __name__ == "__main__":
    with torch.inference_mode():
        write_problem(sys.argv[1])
