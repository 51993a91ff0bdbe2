"""The camera's frame: where pixels look, and the way between the world and the capture frame."""

import math

import torch
from faultpath_quadrotor import so3
from faultpath_quadrotor.perception.camera import (
    FIELD_OF_VIEW_DEG,
    FOCAL_PX,
    HEIGHT,
    WIDTH,
    CaptureFrame,
    rays,
)


def test_the_image_spans_the_field_of_view_and_rows_run_down():
    seen = rays()
    assert seen.shape == (3, HEIGHT, WIDTH)
    assert (seen[0] == 1).all()
    edge = seen[1, 0, 0] + 0.5 / FOCAL_PX
    assert math.isclose(math.degrees(2 * math.atan(edge)), FIELD_OF_VIEW_DEG)
    assert (seen[1].diff(dim=1) < 0).all(), "columns run from left to right"
    assert (seen[2].diff(dim=0) < 0).all(), "rows run from top to bottom"
    torch.testing.assert_close(seen[1:], -seen[1:].flip(1, 2))


def test_the_capture_frame_is_the_bodys_pose_and_there_and_back_is_the_same():
    draws = torch.Generator().manual_seed(3)
    position, turn = torch.randn(2, 3, 4, generator=draws, dtype=torch.float64)
    frame = CaptureFrame(position, so3.exp(turn))
    points = torch.randn(3, 4, 7, generator=draws, dtype=torch.float64)
    back = so3.rotate(frame.rotation[..., None], frame.from_world(points))
    torch.testing.assert_close(back + position[..., None], points)
    ahead = torch.tensor([2.0, 0.0, 0.0], dtype=torch.float64)[:, None, None].expand(3, 4, 1)
    forward = position + 2 * frame.rotation[:, 0]
    torch.testing.assert_close(frame.from_world(forward[..., None]), ahead, msg="x is forward")
    chosen = frame.take([2, 0])
    torch.testing.assert_close(
        chosen.from_world(points[:, [2, 0]]), frame.from_world(points)[:, [2, 0]]
    )
