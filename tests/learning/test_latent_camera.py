"""The example of one camera: its pictures ("latent_camera_pictures.py"), its planner, and a fit and
an audit in quick form."""

import runpy
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

torch = pytest.importorskip("torch")

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "latent_camera.py"
FIT_AND_AUDIT = """
import runpy
import sys
from pathlib import Path

import faultpath

example = sys.argv[1]
sys.path.insert(0, str(Path(example).parent))
sys.argv = [example, "--windows", "150", "--epochs", "1", "--names", "plain,augmented"]
runpy.run_path(example, run_name="__main__")
run = faultpath.audit(
    example,
    baseline="plain",
    repair="augmented",
    fault="exposure:scale=0.85",
    library="training",
    scenes=2,
    options={"weights": "runs/latent-camera"},
    workers=0,
    progress=False,
)
print([path.name for path in run.record.paths])
print(sorted(set(run.table().column("status").to_pylist())))
print([str(finding) for finding in run.record.findings])
"""


@pytest.fixture(scope="module")
def camera() -> Iterator[SimpleNamespace]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(EXAMPLE.parent)  # as Python does for a file that it runs
        yield SimpleNamespace(**runpy.run_path(str(EXAMPLE)))


def taken(
    camera: Any,
    count: int,
    exposure: float = 1.0,
    gamma: float = 1.0,
    shift: float = 0.0,
    smear: float = 0.0,
):
    places = torch.tensor(camera.drawn(np.random.default_rng(3), count)).float()
    ones = torch.ones(count)
    moved = torch.tensor([[shift, 0.0]]).expand(count, 2)
    return camera.picture(places, exposure * ones, gamma * ones, moved, smear * ones, "marked")


def test_a_shift_by_whole_pixels_moves_the_picture(camera: Any) -> None:
    assert torch.allclose(
        taken(camera, 4, shift=2.0)[..., 2:], taken(camera, 4)[..., :-2], atol=1e-5
    )


def test_a_smear_is_the_mean_of_the_pictures_that_it_passes(camera: Any) -> None:
    smeared, right = taken(camera, 4, smear=2.0), taken(camera, 4)
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
    assert [torch.equal(one, two) for one, two in zip(right, mixed, strict=True)] == [
        True,
        False,
        True,
    ]


@pytest.mark.parametrize("error", [{"exposure": 0.85}, {"gamma": 1.3}, {"shift": 2.0}])
def test_a_rectified_picture_is_as_a_calibrated_camera_takes_it(camera: Any, error: Any) -> None:
    rectified, right = camera.Rectified(), taken(camera, 6)
    undone = torch.cat([rectified(seen) for seen in taken(camera, 6, **error).split(1)])
    assert (undone - right).abs().mean() < 0.02 * (taken(camera, 6, **error) - right).abs().mean()


def test_edges_do_not_depend_on_the_exposure(camera: Any) -> None:
    right, dark = camera.edges_of(taken(camera, 3)), camera.edges_of(taken(camera, 3, exposure=0.7))
    assert torch.allclose(right, dark, atol=1e-3)


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


@pytest.mark.slow
def test_it_runs_from_an_empty_folder_and_its_fits_are_matched_and_audited(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", FIT_AND_AUDIT, str(EXAMPLE)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    fitted, paths, ends, findings = done.stdout.splitlines()
    assert fitted.startswith("augmented: matched in all but the repair (uncertainty training: ")
    assert paths == "['correct', 'goal', 'observation', 'shared']"
    assert "failed" not in ends
    assert findings == "[]"
