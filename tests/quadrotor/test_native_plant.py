"""The compiled plant, contact checks and distance field are the portable ones."""

import pytest
import torch
from faultpath_quadrotor import native, so3
from faultpath_quadrotor.plant import PlantState, TorchPlant
from faultpath_quadrotor.plant.module import World
from faultpath_quadrotor.plant.protocol import Vehicle
from faultpath_quadrotor.scenes.field import DistanceField
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.scenes.scene import Box, Cylinder, Scene
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import COLLISION_RADIUS_M, MOTOR_THRUST_MAX_N, VehicleParameters
from flights import hall, spread, tumbling
from test_plant import drawn_vehicles
from torch import Tensor

F64 = torch.float64
LANES = 37
STEPS = 25


def wild(seed: int) -> tuple[PlantState, Tensor, Tensor]:
    """Tumbling vehicles, motors anywhere, commands beyond limits, strong winds."""
    stream = torch.Generator().manual_seed(seed)

    def spread(*shape: int, by: float) -> Tensor:
        return by * torch.randn(*shape, LANES, dtype=F64, generator=stream)

    state = State(spread(3, by=5), spread(3, by=5), so3.exp(spread(3, by=2)), spread(3, by=12))
    thrusts = MOTOR_THRUST_MAX_N * torch.rand(4, LANES, dtype=F64, generator=stream)
    return PlantState(state, thrusts), spread(4, by=20), spread(STEPS, 3, by=6)


def flown(isa: str, seed: int) -> Tensor:
    """All that the plant carries after one control step, `[22, n]`."""
    start, command, winds = wild(seed)
    with native.using(isa):
        end = TorchPlant(drawn_vehicles(LANES, seed)).advance(start, command, winds)
    state = end.state
    parts = (state.position, state.velocity, state.rotation.flatten(0, 1), state.rate, end.thrusts)
    return torch.cat(parts)


@pytest.mark.parametrize("seed", [0, 100, 200])
def test_the_compiled_plant_is_the_portable_one(isa: str, seed: int) -> None:
    torch.testing.assert_close(flown(isa, seed), flown(native.PORTABLE, seed), rtol=0, atol=1e-11)


def test_what_the_kernel_does_not_cover_is_flown_in_torch(isa: str) -> None:
    nominal = Vehicle.stack([VehicleParameters()] * 6)
    two_axes = nominal.map(lambda part: part.unflatten(-1, (2, 3)))
    with native.using(isa):
        for vehicle in (nominal.to(torch.float32), two_axes):
            plant = TorchPlant(vehicle)
            still = torch.zeros(3, *vehicle.mass_kg.shape, dtype=vehicle.mass_kg.dtype)
            now = plant.start(State.hover(still, still[0]))
            end = plant.advance(now, vehicle.hover_command(), still.expand(5, *still.shape))
            assert end.state.position.dtype == vehicle.mass_kg.dtype
            assert end.state.position.abs().max() < 1e-6


def worlds(isa: str, scenes: list[Scene], commands: Tensor, level: str = "L0") -> World:
    """The world after a control step for each of `commands` `[n, 4, L]`."""
    with native.using(isa):
        world = World(scenes, level, free_space=False)
    for command in commands:
        world.advance(command)
    return world


def assert_same_trials(ours: World, theirs: World) -> None:
    for name in ("running", "crashed", "succeeded", "time_s"):
        assert torch.equal(getattr(ours.progress, name), getattr(theirs.progress, name)), name
    for name in ("terminal_distance_m", "min_clearance_m"):
        both = (getattr(world.progress, name) for world in (ours, theirs))
        torch.testing.assert_close(*both, rtol=0, atol=1e-10, equal_nan=True)


SCENES = list(load_library("selection").scenes[:34])
COMMANDS = tumbling(22, 64)


def test_trials_end_at_the_same_moment(isa: str) -> None:
    theirs = worlds(native.PORTABLE, SCENES, COMMANDS, "L2")
    crashed = theirs.progress.crashed[: len(SCENES)].sum()
    assert 5 < crashed < len(SCENES) - 5, "some end, some fly on"
    assert_same_trials(worlds(isa, SCENES, COMMANDS, "L2"), theirs)


def beside(gap_m: float, thing: str) -> Scene:
    """A vehicle above the floor that falls past a solid with so much between it and the solid."""
    away = 1.0 + COLLISION_RADIUS_M + gap_m
    box = Box(centre_m=(away, 0.0, 1.0), half_extents_m=(1.0, 1.0, 1.0), yaw_rad=0.0)
    pillar = Cylinder(centre_m=(0.0, away), radius_m=1.0, low_m=0.0, high_m=2.0)
    things, falls = [box if thing == "box" else pillar], VehicleParameters(drag_kgps=(1e-9,) * 3)
    return hall(0, (0.0, 0.0, 3.5), (0.0, 3.0, 4.0), things, (8.0, 8.0, 5.0), falls)


def test_a_micrometre_decides_between_a_graze_and_a_crash(isa: str) -> None:
    gaps = (1e-6, -1e-6)
    scenes = [beside(gap, thing) for thing in ("box", "pillar") for gap in gaps]
    falling = torch.zeros(20, 4, 32, dtype=F64)
    world = worlds(isa, scenes, falling)
    hits = world.progress
    assert hits.crashed[:4].all(), "those that pass reach the floor"
    past_box, into_box, past_pillar, into_pillar = hits.min_clearance_m[:4].tolist()
    assert into_box == pytest.approx(-1e-6, rel=1e-6) == into_pillar
    assert past_box < -1e-3 > past_pillar, "the floor is met at full speed"
    late, early, later, earlier = hits.time_s[:4].tolist()
    assert early < late - 0.1
    assert earlier < later - 0.1
    assert_same_trials(world, worlds(native.PORTABLE, scenes, falling))


FEW = list(load_library("selection").scenes[:6])


def scattered(count: int) -> Tensor:
    """Points inside, outside and on lattice points of the scenes' arenas, `[3, B, N]`."""
    points = spread(FEW, count, margin=2.0)
    points[..., ::7] = (10 * points[..., ::7]).round() / 10
    return points.float()


def asked(isa: str, points: Tensor) -> Tensor:
    with native.using(isa):
        return DistanceField.bake(FEW).query(points)


@pytest.mark.parametrize("count", [3, 512, 1031])
def test_distances_have_the_bits_of_the_portable_path(isa: str, count: int) -> None:
    points = scattered(count)
    together = asked(isa, points)
    assert torch.equal(together, asked(native.PORTABLE, points))
    assert torch.equal(asked(isa, points[..., 1:3]), together[..., 1:3]), "whatever is beside them"
