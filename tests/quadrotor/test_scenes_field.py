"""The baked field: its error, its border, and independence of what is baked beside it."""

import math

import pytest
import torch
from faultpath_quadrotor.scenes.field import DistanceField, Lattice, exact_on_lattice
from faultpath_quadrotor.scenes.geometry import Geometry
from faultpath_quadrotor.scenes.library import CELL_M, load_library
from faultpath_quadrotor.scenes.scene import Scene
from flights import spread

HALF_DIAGONAL_M = CELL_M * math.sqrt(3) / 2


@pytest.fixture(scope="module")
def scenes() -> list[Scene]:
    return list(load_library("training").scenes[:10])


@pytest.fixture(scope="module")
def field(scenes: list[Scene]) -> DistanceField:
    return DistanceField.bake(scenes)


@pytest.mark.parametrize("free_space", [False, True])
def test_lattice_points_inside_carry_the_exact_distance(scenes, free_space):
    for scene in scenes[:2]:
        lattice = Lattice.over(scene)
        baked = exact_on_lattice(scene, lattice, free_space)
        points = torch.stack(torch.meshgrid(*lattice.axes, indexing="ij"))
        exact = Geometry.stack([scene], free_space).distance(points[:, None])[0]
        inside = baked[2:-2, 2:-2, 2:-2], exact[2:-2, 2:-2, 2:-2]
        torch.testing.assert_close(*inside, rtol=0, atol=1e-9)
        outside = torch.ones_like(baked, dtype=torch.bool)
        outside[2:-2, 2:-2, 2:-2] = False
        assert (baked[outside] < 0).all()


def test_the_interpolation_error_is_as_documented(scenes, field):
    points = spread(scenes, 10_000).float()
    exact = Geometry.stack(scenes).distance(points.double())
    error = (field.query(points) - exact)[exact > 0]
    assert error.abs().max() <= HALF_DIAGONAL_M + 1e-5
    assert 0.004 < error.square().mean().sqrt() < 0.006  # documented: 0.005 m
    assert (error.abs() > 0.03).double().mean() < 0.01


def test_outside_the_field_falls_by_the_distance_beyond_each_wall(scenes, field):
    points = spread(scenes, 4000, margin=30.0).float()
    bounds = [(scene.bounds.low_m, scene.bounds.high_m) for scene in scenes]
    low, high = torch.tensor(bounds).permute(1, 2, 0)[..., None]
    beyond = (low - points).clamp_min(0) + (points - high).clamp_min(0)
    outside = beyond.amax(0) > CELL_M + 1e-4  # nearer, a cell has corners on the face
    assert outside.double().mean() > 0.5
    error = (field.query(points) / beyond.sum(0) + 1).abs()
    assert error[outside].max() < 0.01  # rounding, tens of metres away
    assert error[outside & (beyond.amax(0) < 4.0)].max() < 1e-3


def test_leaving_through_any_face_never_pays(scenes, field):
    way = torch.linspace(0.0, 12.0, 400)
    for axis in range(3):
        for sign in (-1.0, 1.0):
            points = torch.tensor([s.start_m for s in scenes]).T[:, :, None].repeat(1, 1, 400)
            edge = [s.bounds.high_m[axis] if sign > 0 else s.bounds.low_m[axis] for s in scenes]
            points[axis] = torch.tensor(edge)[:, None] + sign * way
            steps = field.query(points).diff(dim=-1)
            assert (steps < 0).all()
