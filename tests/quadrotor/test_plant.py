"""Laws of motion with exact answers, and what vehicles do at their limits."""

import math

import numpy as np
import pytest
import torch
from faultpath_quadrotor import so3
from faultpath_quadrotor.plant import PlantState, TorchPlant, torch_plant
from faultpath_quadrotor.plant.protocol import Vehicle
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import COLLECTIVE_MAX_N, GRAVITY_MPS2, VehicleParameters, draw
from torch import Tensor

F64 = torch.float64
NO_DRAG = (1e-12,) * 3


def drawn_vehicles(count: int, first: int = 0) -> Vehicle:
    seeds = range(first, first + count)
    return Vehicle.stack([draw(np.random.default_rng(seed)) for seed in seeds])


def moving(count: int, seed: int) -> State:
    generator = torch.Generator().manual_seed(seed)
    position, velocity, turn, rate = torch.randn(4, 3, count, dtype=F64, generator=generator)
    return State(position, velocity, so3.exp(turn), rate)


def hovering(count: int) -> State:
    return State.hover(torch.zeros(3, count, dtype=F64), torch.linspace(0, 3, count, dtype=F64))


def calm(steps: int, count: int) -> Tensor:
    return torch.zeros(steps, 3, count, dtype=F64)


def column(*values: float) -> Tensor:
    return torch.tensor(values, dtype=F64)[:, None]


def test_hover_trim_stays_put():
    vehicle = drawn_vehicles(32)
    plant = TorchPlant(vehicle)
    start = plant.start(hovering(32))
    end = plant.advance(start, vehicle.hover_command(), calm(250, 32))
    assert end.state.position.abs().max() < 1e-12
    assert end.state.velocity.abs().max() < 1e-12
    assert torch.equal(end.state.rate, start.state.rate)
    assert torch.allclose(end.thrusts, start.thrusts, rtol=1e-14)


def test_commands_are_clipped_to_the_vehicle_s_limits():
    plant = TorchPlant(drawn_vehicles(2))
    start = plant.start(moving(2, 0))
    wild = torch.tensor([[900.0, -5.0], [70.0, -70.0], [-9.0, 9.0], [30.0, -4.0]], dtype=F64)
    limits = [[COLLECTIVE_MAX_N, 0.0], [6.0, -6.0], [-6.0, 6.0], [3.0, -3.0]]
    limit = torch.tensor(limits, dtype=F64)
    clipped, at_limit, inside = (
        plant.advance(start, command, calm(25, 2)).state.rate
        for command in (wild, limit, 0.9 * limit)
    )
    assert torch.equal(clipped, at_limit)
    assert not torch.allclose(inside, clipped, rtol=1e-3)


def falling(parameters: VehicleParameters, steps: int) -> State:
    """Let a level vehicle with stopped motors go."""
    plant = TorchPlant(Vehicle.stack([parameters]))
    stopped = PlantState(hovering(1), torch.zeros(4, 1, dtype=F64))
    return plant.advance(stopped, column(0.0, 0.0, 0.0, 0.0), calm(steps, 1)).state


def test_free_fall_and_terminal_velocity():
    end = falling(VehicleParameters(drag_kgps=NO_DRAG), 500)
    assert end.position[:, 0].tolist() == pytest.approx([0, 0, -GRAVITY_MPS2 / 2], rel=1e-10)
    assert end.velocity[:, 0].tolist() == pytest.approx([0, 0, -GRAVITY_MPS2], rel=1e-10)
    for mass in (0.5, 1.5):
        parameters = VehicleParameters(mass_kg=mass, drag_kgps=(0.1, 0.2, 2.0))
        terminal = mass * GRAVITY_MPS2 / 2.0
        for steps in (250, 2000):
            speed = -falling(parameters, steps).velocity[2].item()
            expected = terminal * -math.expm1(-2.0 * steps / 500 / mass)
            assert speed == pytest.approx(expected, rel=1e-5)


def spinning(dt_s: float) -> tuple[State, Tensor]:
    """Turn three free bodies for a second; return the end state and the inertia."""
    inertias = [(0.010, 0.010, 0.018), (0.008, 0.012, 0.018), (0.013, 0.009, 0.014)]
    vehicle = Vehicle.stack([VehicleParameters(inertia_kgm2=i) for i in inertias])
    coupling = torch_plant.gyroscopic_coupling(vehicle)
    rate = column(4.0, -3.0, 5.0).expand(3, 3).clone()
    rotation = so3.exp(column(0.3, 0.2, -0.5)).expand(3, 3, 3).clone()
    for _ in range(round(1 / dt_s)):
        free = torch_plant.gyroscopic(coupling, rate)
        still = torch.zeros_like(rate)
        rotation, rate = torch_plant.turn(rotation, rate, still, coupling, free, dt_s)
    return State(rate, rate, rotation, rate), vehicle.inertia_kgm2


def test_torque_free_rotation_conserves_momentum_and_energy():
    end, inertia = spinning(0.002)
    rate0 = column(4.0, -3.0, 5.0)
    momentum0 = so3.rotate(so3.exp(column(0.3, 0.2, -0.5)), inertia * rate0)
    momentum = so3.rotate(end.rotation, inertia * end.rate)
    energy0, energy = ((inertia * w * w).sum(0) for w in (rate0, end.rate))
    assert (end.rate - rate0).abs().max() > 1.0  # they tumble
    assert torch.allclose(energy, energy0, rtol=1e-4)
    assert torch.allclose(momentum, momentum0, rtol=0, atol=5e-4 * momentum0.norm(dim=0).max())
    squared = so3.compose(end.rotation.transpose(0, 1), end.rotation)
    assert torch.allclose(squared, torch.eye(3, dtype=F64)[..., None], atol=1e-12)


def test_motor_lag_and_its_impulse_are_exact():
    tau, mass, scale = 0.05, 0.9, 1.2
    parameters = VehicleParameters(
        mass_kg=mass, drag_kgps=NO_DRAG, thrust_scale=scale, motor_time_constant_s=tau
    )
    plant = TorchPlant(Vehicle.stack([parameters]))
    state = plant.start(hovering(1))
    hover, target = mass * GRAVITY_MPS2 / scale, 16.0
    command = column(target, 0.0, 0.0, 0.0)
    for step in range(1, 51):
        state = plant.advance(state, command, calm(1, 1))
        left = math.exp(-step * 0.002 / tau)
        expected = target + (hover - target) * left
        assert state.thrusts.sum().item() == pytest.approx(expected, rel=1e-12)
    impulse = target * 0.1 + (hover - target) * tau * (1 - left)
    velocity = scale * impulse / mass - GRAVITY_MPS2 * 0.1
    assert state.state.velocity[2].item() == pytest.approx(velocity, rel=1e-9)


def test_the_plant_is_second_order():
    # Without torque, as the sampled rate loop is another controller at another step size.
    vehicle = Vehicle.stack([VehicleParameters(torque_scale=1e-12)])
    turning = State(
        position=column(0.0, 0.0, 0.0),
        velocity=column(2.0, 1.0, -1.0),
        rotation=so3.exp(column(0.4, 0.1, 0.0)),
        rate=column(1.0, -2.0, 1.5),
    )

    def end(dt_s: float) -> State:
        plant = TorchPlant(vehicle, dt_s)
        winds = column(3.0, 0.0, 1.0).expand(round(0.4 / dt_s), 3, 1)
        start = PlantState(turning, torch.full((4, 1), 4.0, dtype=F64))
        return plant.advance(start, column(20.0, 0.0, 0.0, 0.0), winds).state

    reference, coarse = end(0.0005), (end(0.016), end(0.008))
    for name in ("position", "velocity"):
        errors = [(getattr(at, name) - getattr(reference, name)).norm() for at in coarse]
        assert errors[0] > 1e-5
        assert 3.6 < errors[0] / errors[1] < 4.4
