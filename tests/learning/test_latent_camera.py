"""The example of one camera: its pictures ("latent_camera_pictures.py") and its planner."""

import runpy
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

torch = pytest.importorskip("torch")

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "latent_camera.py"


@pytest.fixture(scope="module")
def camera() -> Iterator[SimpleNamespace]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(EXAMPLE.parent)  # as Python does for a file that it runs
        yield SimpleNamespace(**runpy.run_path(str(EXAMPLE)))


def taken(camera: Any, count: int, shift: float = 0.0, smear: float = 0.0, **light: float):
    places = torch.tensor(camera.drawn(np.random.default_rng(3), count)).float()
    ones = torch.ones(count)
    moved = torch.tensor([[shift, 0.0]]).expand(count, 2)
    exposure, gamma = (light.get(name, 1.0) * ones for name in ("exposure", "gamma"))
    return camera.picture(places, exposure, gamma, moved, smear * ones, "marked")


def test_a_shift_moves_the_picture_and_a_smear_is_the_mean_of_those_passed(camera: Any) -> None:
    right, smeared = taken(camera, 4), taken(camera, 4, smear=2.0)
    assert torch.allclose(taken(camera, 4, shift=2.0)[..., 2:], right[..., :-2], atol=1e-5)
    passed = (right[..., :-2] + right[..., 1:-1] + right[..., 2:]) / 3
    assert torch.allclose(smeared[..., 1:-1], passed, atol=1e-5)
    assert torch.equal(smeared, taken(camera, 4, smear=-2.0))


def test_a_smear_of_one_picture_changes_no_bit_of_those_beside_it(camera: Any) -> None:
    places, ones = torch.full((3, 2), 8.0), torch.ones(3)
    others = ones, ones, torch.zeros(3, 2)
    right, mixed = (
        camera.picture(places, *others, torch.tensor(smears), "marked")
        for smears in ([0.0, 0.0, 0.0], [0.0, 6.0, 0.0])
    )
    same = [torch.equal(one, two) for one, two in zip(right, mixed, strict=True)]
    assert same == [True, False, True]


@pytest.mark.parametrize("error", [{"exposure": 0.85}, {"gamma": 1.3}, {"shift": 2.0}])
def test_a_rectified_picture_is_as_a_calibrated_camera_takes_it(camera: Any, error: Any) -> None:
    rectified, right = camera.Rectified(), taken(camera, 6)
    wrong = taken(camera, 6, **error)
    undone = torch.cat([rectified(seen) for seen in wrong.split(1)])
    assert (undone - right).abs().mean() < 0.02 * (wrong - right).abs().mean()
    if "exposure" in error:
        edges = (camera.edges_of(seen) for seen in (right, wrong))
        torch.testing.assert_close(*edges, atol=1e-3, rtol=0)


def test_the_wall_stops_what_runs_into_it_and_the_door_lets_pass(camera: Any) -> None:
    places, action = np.array([[12.0, 5.0], [12.0, 16.0]]), np.array([[1.0, 0.0], [1.0, 0.0]])
    for _ in range(3):
        places = camera.moved(places, action)
    assert places[0, 0] < camera.WALL[0] < camera.WALL[1] < places[1, 0]


def test_scenes_beside_it_change_no_bit_of_a_plan(camera: Any) -> None:
    planner = camera.Planner(camera.WorldModel().eval())
    torch.manual_seed(0)
    start, target, mean = torch.randn(5, 32), torch.randn(5, 32), torch.zeros(5, 6, 2)
    noise = torch.randn(5, 8, 64, 6, 2)
    plans = planner.plan(start, target, mean, noise)
    for rows in ([3], [4, 0, 2]):
        alone = planner.plan(start[rows], target[rows], mean[rows], noise[rows])
        assert torch.equal(alone, plans[rows])
