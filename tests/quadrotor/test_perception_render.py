"""What the camera sees against the geometry that contact uses, and against MuJoCo's rays."""

import math

import numpy as np
import pytest
import torch
from faultpath_quadrotor import so3
from faultpath_quadrotor.perception.camera import RANGE_M, rays
from faultpath_quadrotor.perception.render import DepthRenderer
from faultpath_quadrotor.scenes.geometry import Geometry
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.scenes.scene import Box, Scene
from faultpath_quadrotor.state import State
from flights import hall


def posed(position: torch.Tensor, rotation: torch.Tensor) -> State:
    return State(position, torch.zeros_like(position), rotation, torch.zeros_like(position))


def flown(scenes: list[Scene], seed: int = 0) -> State:
    """Free poses, tilted at will, one a scene."""
    draws = np.random.default_rng(seed)
    geometry = Geometry.stack(scenes)
    position = torch.zeros(3, len(scenes), dtype=torch.float64)
    free = torch.zeros(len(scenes), dtype=torch.bool)
    low = np.array([scene.bounds.low_m for scene in scenes])
    high = np.array([scene.bounds.high_m for scene in scenes])
    while not free.all():
        drawn = torch.from_numpy(draws.uniform(low, high).T.copy())
        position = torch.where(free, position, drawn)
        free = geometry.distance(position) > 0.2
    tilt = torch.from_numpy(draws.normal(0, 0.4, (3, len(scenes))))
    yaw = torch.from_numpy(draws.uniform(0, 2 * math.pi, len(scenes)))
    return posed(position, so3.compose(so3.from_yaw(yaw), so3.exp(tilt)))


@pytest.mark.parametrize("free_space", [False, True])
def test_depth_ends_on_the_first_surface_of_the_contact_geometry(free_space: bool):
    scenes = list(load_library("training").scenes[:12])
    state = flown(scenes)
    depth = DepthRenderer(scenes, free_space).render(state).double()
    geometry = Geometry.stack(scenes, free_space)
    world = so3.rotate(state.rotation[..., None], rays().flatten(1)[:, None])

    def distance(fraction: float) -> torch.Tensor:
        along = world * (depth.flatten(1) * fraction)
        return geometry.distance(state.position[..., None] + along)

    hit = depth.flatten(1) < RANGE_M
    assert hit.double().mean() > 0.8
    assert distance(1.0)[hit].abs().max() < 2e-5
    for fraction in np.linspace(0, 0.999, 25):
        assert (distance(fraction) > -2e-5).all(), "no surface lies before it"


def test_boxes_look_the_same_to_mujocos_rays():
    mujoco = pytest.importorskip("mujoco")
    boxes = [
        Box(centre_m=(1.0, 0.4, 0.9), half_extents_m=(0.2, 0.5, 0.6), yaw_rad=0.6),
        Box(centre_m=(2.2, -0.9, 1.8), half_extents_m=(0.3, 0.2, 0.4), yaw_rad=-1.1),
        Box(centre_m=(0.4, -0.8, 2.2), half_extents_m=(0.1, 0.1, 0.3), yaw_rad=2.0),
    ]
    solid = "".join(
        f'<geom type="box" pos="{" ".join(map(str, box.centre_m))}" '
        f'size="{" ".join(map(str, box.half_extents_m))}" euler="0 0 {box.yaw_rad}"/>'
        for box in boxes
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><worldbody>{solid}</worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    place, tilt = torch.tensor([[-1.2, 0.1, 1.3], [0.2, 0.1, 0.3]]).double()[..., None]
    state = posed(place, so3.exp(tilt))
    depth = DepthRenderer([hall(0, things=boxes)]).render(state)[0].double().flatten().numpy()
    empty = DepthRenderer([hall(0)]).render(state)[0].double().flatten().numpy()

    seen = rays().flatten(1)
    length = seen.norm(dim=0).numpy()
    world = so3.rotate(state.rotation, seen).T.numpy() / length[:, None]
    count = len(length)
    found, geom = np.zeros(count), np.zeros(count, dtype=np.int32)
    mujoco.mj_multiRay(
        model, data, state.position[:, 0].numpy(), world.flatten(), None, True, -1, geom, found,
        None, count, 100.0,
    )  # fmt: skip
    theirs = np.where(geom >= 0, found / length, np.inf)
    expected = np.minimum(theirs, empty)
    assert (theirs < empty).sum() > 300
    assert np.abs(depth - expected).max() < 1e-5
