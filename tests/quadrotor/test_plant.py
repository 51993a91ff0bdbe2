"""What flying vehicles do: hover, saturate, scale, and nothing that their neighbours change."""

import numpy as np
import pytest
import torch
from faultpath_quadrotor import so3
from faultpath_quadrotor.plant import PlantState, TorchPlant
from faultpath_quadrotor.plant.vehicle_batch import Vehicle
from faultpath_quadrotor.state import State, padded_lanes
from faultpath_quadrotor.vehicle import COLLECTIVE_MAX_N, GRAVITY_MPS2, VehicleParameters, draw
from torch import Tensor

F64 = torch.float64


def drawn_vehicles(count: int, first: int = 0) -> Vehicle:
    seeds = range(first, first + count)
    return Vehicle.stack([draw(np.random.default_rng(seed)) for seed in seeds])


def hovering(count: int) -> State:
    return State.hover(torch.zeros(3, count, dtype=F64), torch.linspace(0, 3, count, dtype=F64))


def calm(steps: int, count: int) -> Tensor:
    return torch.zeros(steps, 3, count, dtype=F64)


def moving(count: int, seed: int) -> State:
    generator = torch.Generator().manual_seed(seed)
    position, velocity, turn, rate = torch.randn(4, 3, count, dtype=F64, generator=generator)
    return State(position, velocity, so3.exp(turn), rate)


def test_hover_trim_stays_put():
    vehicle = drawn_vehicles(32)
    plant = TorchPlant(vehicle)
    start = plant.start(hovering(32))
    end = plant.advance(start, vehicle.hover_command(), calm(250, 32))
    assert end.state.position.abs().max() < 1e-12
    assert end.state.velocity.abs().max() < 1e-12
    assert torch.equal(end.state.rate, start.state.rate)
    assert torch.allclose(end.thrusts, start.thrusts, rtol=1e-14)


@pytest.mark.parametrize("scale", [0.6, 1.0, 1.4])
def test_thrust_scale_multiplies_realised_thrust(scale):
    instant = {"motor_time_constant_s": 1e-9, "drag_kgps": (1e-12,) * 3}
    parameters = VehicleParameters(mass_kg=0.8, thrust_scale=scale, **instant)
    plant = TorchPlant(Vehicle.stack([parameters]))
    command = torch.tensor([[12.0], [0.0], [0.0], [0.0]], dtype=F64)
    end = plant.advance(plant.start(hovering(1)), command, calm(50, 1))
    expected = (scale * 12.0 / 0.8 - GRAVITY_MPS2) * 0.1
    assert end.state.velocity[2].item() == pytest.approx(expected, rel=1e-6)


def test_commands_are_clipped_to_the_vehicle_s_limits():
    plant = TorchPlant(drawn_vehicles(2))
    start = plant.start(moving(2, 0))
    wild = torch.tensor([[900.0, -5.0], [70.0, -70.0], [-9.0, 9.0], [30.0, -4.0]], dtype=F64)
    limits = [[COLLECTIVE_MAX_N, 0.0], [6.0, -6.0], [-6.0, 6.0], [3.0, -3.0]]
    limit = torch.tensor(limits, dtype=F64)
    clipped = plant.advance(start, wild, calm(25, 2))
    assert torch.equal(clipped.state.rate, plant.advance(start, limit, calm(25, 2)).state.rate)
    inside = plant.advance(start, 0.9 * limit, calm(25, 2))
    assert not torch.allclose(inside.state.rate, clipped.state.rate, rtol=1e-3)


def bits(state: PlantState) -> list[bytes]:
    return [x.contiguous().numpy().tobytes() for x in (*vars(state.state).values(), state.thrusts)]


def fly(lanes: Tensor) -> PlantState:
    """Fly the given ones of 70 vehicles as the application does: padded to whole groups."""
    pick = lanes[padded_lanes(len(lanes))]
    generator = torch.Generator().manual_seed(6)
    winds = 3 * torch.randn(50, 3, 70, dtype=F64, generator=generator)
    commands = torch.randn(2, 4, 70, dtype=F64, generator=generator)
    vehicle = drawn_vehicles(70)
    plant = TorchPlant(vehicle.take(pick))
    now = PlantState(moving(70, 7), torch.rand(4, 70, dtype=F64, generator=generator)).take(pick)
    for k in range(2):
        command = vehicle.hover_command() * 1.2 + commands[k] * 4
        now = plant.advance(now, command[:, pick], winds[25 * k : 25 * k + 25, :, pick])
    return now.take(torch.arange(len(lanes)))


def test_neighbours_and_order_change_no_bit():
    everyone = torch.arange(70)
    together = fly(everyone)
    assert len({bytes(x) for x in together.state.position.T.numpy()}) == 70
    order = torch.randperm(70, generator=torch.Generator().manual_seed(8))
    assert bits(fly(order)) == bits(together.take(order))
    for lane in (0, 31, 37, 64, 69):
        one = torch.tensor([lane])
        assert bits(fly(one)) == bits(together.take(one))
