"""The compiled depth camera draws the images of the portable one."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from faultpath_quadrotor import native
from faultpath_quadrotor.perception.camera import HEIGHT, WIDTH, mounted
from faultpath_quadrotor.perception.render import DepthRenderer
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.scenes.scene import Scene
from faultpath_quadrotor.state import State
from test_perception_render import flown

ROUNDING_M = 1e-6


def roots_are_exact() -> bool:
    """Return whether torch rounds roots as IEEE 754 asks, which its library does not everywhere."""
    squares = torch.linspace(0.0, 64.0, 10_001)
    return torch.equal(squares.sqrt(), torch.from_numpy(np.sqrt(squares.numpy())))


def drawn(isa: str, scenes: list[Scene], state: State) -> torch.Tensor:
    with native.using(isa):
        return DepthRenderer(scenes).render(state)


@pytest.mark.parametrize("level", [True, False])
def test_images_are_those_of_the_portable_path_silhouettes_included(isa, level):
    scenes = [s for name in ("selection", "training") for s in load_library(name).scenes[:40]]
    state = flown(scenes, seed=1)
    if level:
        state = replace(state, rotation=mounted(state.rotation))
    ours, theirs = (drawn(name, scenes, state) for name in (isa, native.PORTABLE))
    assert ours.shape == (len(scenes), HEIGHT, WIDTH)
    torch.testing.assert_close(ours, theirs, rtol=0, atol=ROUNDING_M)
    least = 0.999 if roots_are_exact() else 0.99
    assert (ours == theirs).float().mean() > least, "roots alone may differ in their last bit"
