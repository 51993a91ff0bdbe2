"""Exact distance against independent measures; nothing beside a scene in a batch may matter."""

import math

import numpy as np
import pytest
import torch
from faultpath_quadrotor.scenes.geometry import Geometry
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.scenes.scene import Cylinder, Scene
from flights import hall, spread
from scipy.spatial import cKDTree


def at(scene: Scene, *points: tuple[float, float, float]) -> list[float]:
    tensor = torch.tensor(points, dtype=torch.float64).T[:, None, :]
    return Geometry.stack([scene]).distance(tensor)[0].tolist()


def test_a_pillar_is_round_and_a_short_one_has_a_top():
    pillars = [
        Cylinder(centre_m=(1.0, 0.0), radius_m=0.3, low_m=0.0, high_m=3.0),
        Cylinder(centre_m=(-1.0, 0.0), radius_m=0.3, low_m=0.0, high_m=1.0),
    ]
    tall, short = [(1.3, 0.4, 1.0), (1.0, 0.1, 0.05)], [(-1.0, 0.0, 1.4), (-1.0, 0.6, 1.4)]
    found = at(hall(0, things=pillars), *tall, *short, (-1.0, 0.0, 0.9))
    assert found == pytest.approx([0.2, -0.2, 0.4, 0.5, -0.1], abs=1e-12)


def test_the_arena_is_free_inside_and_solid_outside():
    points = [(0.0, 0.0, 1.0), (4.9, 0.0, 1.5), (0.0, 0.0, -0.2), (5.3, 3.4, 1.5), (10.0, 0.0, 1.5)]
    assert at(hall(0), *points) == pytest.approx([1.0, 0.1, -0.2, -0.5, -5.0], abs=1e-12)


def surface(scene: Scene, spacing: float) -> np.ndarray:
    """Points on every face of obstacles and arena, `[n, 3]`; uses none of the code under test."""

    def sheet(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.stack(np.meshgrid(u, v, indexing="ij"), -1).reshape(-1, 2)

    def ticks(low: float, high: float) -> np.ndarray:
        return np.linspace(low, high, max(2, math.ceil((high - low) / spacing) + 1))

    def hull(half: np.ndarray) -> np.ndarray:
        faces = []
        for axis in range(3):
            others = [k for k in range(3) if k != axis]
            for sign in (-1, 1):
                face = np.empty((0, 3))
                flat = sheet(*(ticks(-half[k], half[k]) for k in others))
                face = np.empty((len(flat), 3))
                face[:, others], face[:, axis] = flat, sign * half[axis]
                faces.append(face)
        return np.concatenate(faces)

    low, high = np.array(scene.bounds.low_m), np.array(scene.bounds.high_m)
    found = [hull((high - low) / 2) + (high + low) / 2]
    for box in scene.boxes:
        points = hull(np.array(box.half_extents_m))
        c, s = math.cos(box.yaw_rad), math.sin(box.yaw_rad)
        turned = points @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T
        found.append(turned + np.array(box.centre_m))
    for pillar in scene.cylinders:
        angle = ticks(0, 2 * math.pi * pillar.radius_m) / pillar.radius_m
        rim = np.stack([np.cos(angle), np.sin(angle)], -1)
        for radius in ticks(0.0, pillar.radius_m):
            for height in (pillar.low_m, pillar.high_m):
                found.append(np.c_[radius * rim, np.full(len(rim), height)])
                found[-1][:, :2] += pillar.centre_m
        side = pillar.radius_m * rim + pillar.centre_m
        heights = ticks(pillar.low_m, pillar.high_m)
        found.extend(np.c_[side, np.full(len(rim), height)] for height in heights)
    return np.concatenate(found)


@pytest.mark.parametrize("index", range(5))
def test_in_free_space_the_distance_is_that_to_the_nearest_of_many_surface_points(index):
    scene, spacing = load_library("training")[index], 0.04
    points = spread([scene], 3000)
    distance = Geometry.stack([scene]).distance(points)[0].numpy()
    nearest, _ = cKDTree(surface(scene, spacing)).query(points[:, 0].numpy().T)
    free = distance > 0
    assert 0.4 < free.mean() < 1.0
    # No sample is nearer than the surface. One lies within half a diagonal of the nearest place,
    # which bounds its distance, more loosely where the surface bends away (radius from 0.1 m).
    bend = spacing * np.sqrt((1 + distance[free] / 0.1) / 2)
    assert (nearest[free] >= distance[free] - 1e-9).all()
    assert (nearest[free] <= np.hypot(distance[free], bend) + 1e-9).all()


def test_neither_neighbours_nor_place_nor_padding_change_a_bit():
    scenes = list(load_library("training").scenes[:32])
    points = spread(scenes, 1, margin=0.5)[:, :, 0]
    together = Geometry.stack(scenes).distance(points)
    alone = [Geometry.stack([s]).distance(points[:, b : b + 1]) for b, s in enumerate(scenes)]
    assert torch.equal(together, torch.cat(alone))
    order = torch.randperm(32, generator=torch.Generator().manual_seed(1))
    shuffled = Geometry.stack([scenes[k] for k in order.tolist()]).distance(points[:, order])
    assert torch.equal(shuffled, together[order])
    assert len({len(scene.boxes) + len(scene.cylinders) for scene in scenes}) > 1
