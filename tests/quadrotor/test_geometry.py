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


def test_a_pillar_is_round_a_short_one_has_a_top_and_the_arena_is_solid_outside():
    pillars = [
        Cylinder(centre_m=(1.0, 0.0), radius_m=0.3, low_m=0.0, high_m=3.0),
        Cylinder(centre_m=(-1.0, 0.0), radius_m=0.3, low_m=0.0, high_m=1.0),
    ]
    expected = {
        (1.3, 0.4, 1.0): 0.2,
        (1.0, 0.1, 0.05): -0.2,
        (-1.0, 0.0, 1.4): 0.4,
        (-1.0, 0.6, 1.4): 0.5,
        (-1.0, 0.0, 0.9): -0.1,
        (4.9, 0.0, 1.5): 0.1,
        (0.0, 0.0, -0.2): -0.2,
        (5.3, 3.4, 1.5): -0.5,
        (10.0, 0.0, 1.5): -5.0,
    }
    points = torch.tensor(list(expected), dtype=torch.float64).T[:, None]
    distance = Geometry.stack([hall(0, things=pillars)]).distance(points)[0]
    assert distance.tolist() == pytest.approx(list(expected.values()), abs=1e-12)


def surface(scene: Scene, spacing: float) -> np.ndarray:
    """Points on every face of obstacles and arena, `[n, 3]`; uses none of the code under test."""

    def ticks(low: float, high: float) -> np.ndarray:
        return np.linspace(low, high, max(2, math.ceil((high - low) / spacing) + 1))

    def hull(half: np.ndarray) -> np.ndarray:
        faces = []
        for axis in range(3):
            others = [k for k in range(3) if k != axis]
            for sign in (-1, 1):
                grid = np.meshgrid(*(ticks(-half[k], half[k]) for k in others), indexing="ij")
                flat = np.stack(grid, -1).reshape(-1, 2)
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
