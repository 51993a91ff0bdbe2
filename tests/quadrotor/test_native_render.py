"""The compiled depth camera draws the images of the portable one."""

import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from kernel_sets import COMPILED, FUSED, PORTABLE
from test_perception_render import at, flown, scene_of

from faultpath.quadrotor import native
from faultpath.quadrotor.perception.camera import HEIGHT, RANGE_M, WIDTH, mounted
from faultpath.quadrotor.perception.render import DepthRenderer
from faultpath.quadrotor.scenes.library import load_library
from faultpath.quadrotor.scenes.scene import Box, Cylinder, Scene
from faultpath.quadrotor.state import State

SCENES = [*load_library("selection").scenes[:40], *load_library("training").scenes[:40]]
ROUNDING_M = 1e-6


def roots_are_exact() -> bool:
    """Return whether torch rounds roots as IEEE 754 asks, which its library does not everywhere."""
    squares = torch.linspace(0.0, 64.0, 10_001)
    return torch.equal(squares.sqrt(), torch.from_numpy(np.sqrt(squares.numpy())))


def drawn(isa: str, scenes: list[Scene], state: State, free_space: bool = False) -> torch.Tensor:
    with native.using(isa):
        return DepthRenderer(scenes, free_space).render(state)


@pytest.mark.parametrize("isa", COMPILED)
@pytest.mark.parametrize("level", [True, False])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_images_are_those_of_the_portable_path_silhouettes_included(
    isa: str, level: bool, seed: int
) -> None:
    state = flown(SCENES, seed)
    if level:
        state = replace(state, rotation=mounted(state.rotation))
    ours, theirs = (drawn(name, SCENES, state) for name in (isa, PORTABLE))
    assert ours.shape == (len(SCENES), HEIGHT, WIDTH)
    torch.testing.assert_close(ours, theirs, rtol=0, atol=ROUNDING_M)
    least = 0.999 if roots_are_exact() else 0.99
    assert (ours == theirs).float().mean() > least, "roots alone may differ in their last bit"


@pytest.mark.parametrize("isa", COMPILED)
def test_without_obstacles_the_walls_are_the_same_to_the_bit(isa: str) -> None:
    state = flown(SCENES)
    ours, theirs = (drawn(name, SCENES, state, free_space=True) for name in (isa, PORTABLE))
    assert torch.equal(ours, theirs)


def test_fused_sets_draw_the_same_bits() -> None:
    state = flown(SCENES)
    first, *others = [drawn(isa, SCENES, state) for isa in FUSED] or [torch.zeros(0)]
    assert all(torch.equal(first, other) for other in others)


BOX = Box(centre_m=(0.0, 0.4, 1.0), half_extents_m=(0.5, 0.3, 0.4), yaw_rad=0.5)
PILLAR = Cylinder(centre_m=(1.0, -1.0), radius_m=0.3, low_m=0.0, high_m=2.2)


@pytest.mark.parametrize("isa", COMPILED)
@pytest.mark.parametrize("yaw", [0.0, 0.7, math.pi, -1.9])
def test_cameras_close_to_and_inside_solids_see_the_same(isa: str, yaw: float) -> None:
    places = [(0.0, 0.4, 1.0), (-0.56, 0.4, 1.39), (-0.1, 0.0, 1.45), (1.0, -0.69, 0.5)]
    places += [(1.1, -1.1, 1.0), (1.0, -1.0, 2.21), (-3.99, 2.99, 0.01)]
    scenes = [scene_of(BOX, PILLAR)] * len(places)
    shots = [at(*place, yaw=yaw) for place in places]
    parts = ("position", "velocity", "rotation", "rate")
    state = State(*(torch.cat([getattr(shot, part) for shot in shots], -1) for part in parts))
    ours, theirs = (drawn(name, scenes, state) for name in (isa, PORTABLE))
    torch.testing.assert_close(ours, theirs, rtol=0, atol=ROUNDING_M)
    assert (ours[0] == 0).any(), "inside the box"


@pytest.mark.parametrize("isa", COMPILED)
def test_a_scene_s_image_does_not_depend_on_its_neighbours(isa: str) -> None:
    state = flown(SCENES)
    together = drawn(isa, SCENES, state)
    for rows in ([0], [79, 3], list(range(20, 37))):
        few = drawn(isa, [SCENES[i] for i in rows], state.take(torch.tensor(rows)))
        assert torch.equal(few, together[rows])
    assert torch.equal(drawn(isa, SCENES[:5], state), together[:5]), "spare lanes"


@pytest.mark.parametrize("isa", [*COMPILED, PORTABLE])
def test_a_pose_that_is_no_number_blinds_its_own_camera_only(isa: str) -> None:
    scenes = SCENES[:3]
    state = flown(scenes)
    state.position[0, 1] = torch.nan
    image = drawn(isa, scenes, state)
    assert image[1].isnan().all()
    assert (image[::2] <= RANGE_M).all()


@pytest.mark.parametrize("isa", COMPILED)
def test_too_few_poses_are_refused(isa: str) -> None:
    with pytest.raises(RuntimeError, match="expand"):
        drawn(isa, SCENES[:4], flown(SCENES[:2]))
