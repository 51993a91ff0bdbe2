"""The camera's frame, and what counts as free in one image: signs, frontiers, the unseen."""

import math

import numpy as np
import torch
from faultpath_quadrotor import so3
from faultpath_quadrotor.perception import labels
from faultpath_quadrotor.perception.camera import (
    FIELD_OF_VIEW_DEG,
    FOCAL_PX,
    HEIGHT,
    RANGE_M,
    WIDTH,
    captured,
    rays,
)
from faultpath_quadrotor.perception.labels import visible_distance
from faultpath_quadrotor.perception.render import DepthRenderer
from faultpath_quadrotor.scenes.library import load_library
from test_perception_render import flown

WALL = torch.full((HEIGHT, WIDTH), 3.0)
SCENES = list(load_library("training").scenes[:2])
IMAGES = DepthRenderer(SCENES).render(flown(SCENES, seed=5))


def test_before_a_wall_the_label_is_the_distance_and_behind_it_minus_the_depth():
    depths = [1.0, 2.5, 2.9, 3.1, 3.25, 3.31, 7.0]
    points = torch.tensor([[depth, 0.02, 0.01] for depth in depths]).T
    expected = torch.tensor([1.0, 0.5, 0.1, -0.1, -0.25, -0.3, -0.3]).double()
    torch.testing.assert_close(visible_distance(WALL, points), expected, atol=1e-6, rtol=0)


def test_an_occlusion_frontier_counts_like_a_surface():
    image = WALL.clone()
    image[:, : WIDTH // 2] = 1.0  # the left half is a near screen that ends straight ahead
    beside, behind = visible_distance(image, torch.tensor([[2.0, 2.0], [-0.2, 0.2], [0.0, 0.0]]))
    # The frontier runs along the ray between columns 31 and 32, whose directions differ by a pixel.
    assert 0.2 - 1 / FOCAL_PX < beside < 0.2 + 1 / FOCAL_PX
    assert -0.2 - 1 / FOCAL_PX < behind < -0.2 + 1 / FOCAL_PX


def test_the_distance_is_that_of_the_nearest_triangle_and_its_sign_turns_where_a_pixel_hits():
    draws = torch.Generator().manual_seed(2)
    for image in IMAGES:
        inner = torch.arange(HEIGHT * WIDTH).view(HEIGHT, WIDTH)[1:-1, 1:-1].flatten()[::23]
        inner = inner[image.flatten()[inner] < RANGE_M - 0.5]
        assert len(inner) > 50
        hit = rays().flatten(1)[:, inner] * image.flatten()[inner].double()
        for fraction in (0.3, 0.9, 0.99, 1.01, 1.1, 1.5):
            assert ((visible_distance(image, hit * fraction) > 0) == (fraction < 1)).all()
        pixel = torch.randint(0, HEIGHT * WIDTH, (30,), generator=draws)
        points = (rays().flatten(1) * image.flatten())[:, pixel]
        points = points + 0.4 * torch.randn(3, 30, generator=draws)
        every = labels.triangles(image.double().numpy())
        tiled = (np.tile(point, (len(every), 1)) for point in points.double().numpy().T)
        slow = np.array([labels._triangle_distance(every, point).min() for point in tiled])
        found = visible_distance(image, points).abs().numpy()
        ours = np.where(found < 0.3, slow, np.maximum(slow, 0.3)).clip(max=1)
        assert np.abs(found - ours)[found != 0.3].max() < 0.01


def test_the_image_spans_the_field_of_view_and_rows_run_down():
    seen = rays()
    assert seen.shape == (3, HEIGHT, WIDTH)
    assert (seen[0] == 1).all()
    edge = seen[1, 0, 0] + 0.5 / FOCAL_PX
    assert math.isclose(math.degrees(2 * math.atan(edge)), FIELD_OF_VIEW_DEG)
    assert (seen[1].diff(dim=1) < 0).all(), "columns run from left to right"
    assert (seen[2].diff(dim=0) < 0).all(), "rows run from top to bottom"
    torch.testing.assert_close(seen[1:], -seen[1:].flip(1, 2))


def test_the_capture_frame_is_the_bodys_pose_and_x_is_forward():
    draws = torch.Generator().manual_seed(3)
    position, turn = torch.randn(2, 3, 4, generator=draws, dtype=torch.float64)
    rotation = so3.exp(turn)
    pose = position.T, rotation.movedim(-1, 0)
    points = torch.randn(3, 4, 7, generator=draws, dtype=torch.float64)
    points[..., 0] = position + 2 * rotation[:, 0]
    seen = captured(points, *pose)
    torch.testing.assert_close(seen[:, 1, 0], torch.tensor([2.0, 0.0, 0.0]).double())
    back = so3.rotate(rotation[..., None], seen)
    torch.testing.assert_close(back + position[..., None], points)
