"""Exact distance against independent measures; nothing beside a scene in a batch may matter."""

import numpy as np
import pytest
import torch
from faultpath_quadrotor.scenes.geometry import Geometry
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.scenes.scene import Cylinder, Scene
from flights import hall, spread
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation


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


def surface(scene: Scene, per_m2: float) -> np.ndarray:
    """Points drawn on every face of obstacles and arena, `[n, 3]`, without the code under test."""
    draws, bounds = np.random.default_rng(0), scene.bounds
    low, high = np.array(bounds.low_m), np.array(bounds.high_m)

    def hull(half: np.ndarray) -> np.ndarray:
        count = int(24 * per_m2 * half.max() ** 2)
        points, face = draws.uniform(-1, 1, (count, 3)), draws.integers(3, size=count)
        rows = np.arange(count)
        points[rows, face] = np.sign(points[rows, face])
        return points * half

    clouds = [hull((high - low) / 2) + (high + low) / 2]
    for box in scene.boxes:
        turn = Rotation.from_euler("z", box.yaw_rad)
        clouds.append(turn.apply(hull(np.array(box.half_extents_m))) + np.array(box.centre_m))
    for pillar in scene.cylinders:
        size = np.array([pillar.radius_m, pillar.radius_m, pillar.high_m - pillar.low_m])
        angle, away, height = draws.uniform(size=(3, int(12 * per_m2 * size.max())))
        angle, away = 2 * np.pi * angle, np.sqrt(away)
        away[::2], height[1::2] = 1.0, height[1::2].round()  # on the side, or at an end
        points = np.stack([away * np.cos(angle), away * np.sin(angle), height], axis=1)
        clouds.append(points * size + (*pillar.centre_m, pillar.low_m))
    return np.concatenate(clouds)


@pytest.mark.parametrize("index", range(4))
def test_in_free_space_the_distance_is_that_to_the_nearest_of_many_surface_points(index):
    scene = load_library("training").scenes[index]
    points = spread([scene], 3000)
    distance = Geometry.stack([scene]).distance(points)[0].numpy()
    nearest, _ = cKDTree(surface(scene, 250.0)).query(points[:, 0].numpy().T)
    free = distance > 0
    assert 0.4 < free.mean() < 1.0
    # No point drawn is nearer than the surface, and one lies near its nearest place.
    beyond = nearest[free] - distance[free]
    assert beyond.min() >= -1e-9
    assert (np.quantile(beyond, [0.5, 0.95, 1.0]) < [0.002, 0.015, 0.12]).all()
