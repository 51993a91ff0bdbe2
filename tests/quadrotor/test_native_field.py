"""The compiled distance field is the portable one, to the bit."""

import numpy as np
import pytest
import torch
from faultpath_quadrotor import native
from faultpath_quadrotor.scenes.field import DistanceField
from faultpath_quadrotor.scenes.library import load_library
from torch import Tensor

SCENES = list(load_library("selection").scenes[:6])


def scattered(count: int) -> Tensor:
    """Points inside, outside and on lattice points of the scenes' arenas, `[3, B, N]`."""
    draws = np.random.default_rng(3)
    low = np.array([scene.bounds.low_m for scene in SCENES]).T[:, :, None]
    high = np.array([scene.bounds.high_m for scene in SCENES]).T[:, :, None]
    points = draws.uniform(low - 2, high + 2, (3, len(SCENES), count))
    points[..., ::7] = points[..., ::7].round(1)
    return torch.from_numpy(points).float()


def asked(isa: str, points: Tensor, rows: list[int] | None = None) -> Tensor:
    with native.using(isa):
        field = DistanceField.bake(SCENES)
        return (field if rows is None else field.select(rows)).query(points)


@pytest.mark.parametrize("count", [3, 512, 1031])
def test_distances_have_the_bits_of_the_portable_path(isa: str, count: int) -> None:
    points = scattered(count)
    assert torch.equal(asked(isa, points), asked(native.PORTABLE, points))


def test_a_point_s_distance_does_not_depend_on_its_neighbours(isa: str) -> None:
    points = scattered(100)
    together = asked(isa, points)
    for some in (slice(0, 1), slice(5, 22), slice(83, 100)):
        assert torch.equal(asked(isa, points[..., some]), together[..., some])
