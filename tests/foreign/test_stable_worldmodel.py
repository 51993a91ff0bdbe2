"""stable-worldmodel's planner behind taps: the loop is theirs, and an error reaches who reads."""

from contextlib import redirect_stdout
from importlib import import_module
from importlib.util import find_spec
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from foreign_trials import attempted, faulted, imported

if find_spec("stable_worldmodel") is None:  # importing it is the example's, which knows how
    pytest.skip("stable-worldmodel is not installed", allow_module_level=True)


SCENES = ("seed/20", "seed/21")


@pytest.fixture(scope="module")
def example():
    """The example, with a planner of few samples."""
    with pytest.MonkeyPatch.context() as patch:
        few = {"num_samples": 32, "n_steps": 3, "topk": 4}
        yield imported(patch, "stable_worldmodel_camera.py", CEM=few)


@pytest.fixture
def model(example):
    return import_module(Path("stable_worldmodel_model.py").stem)


def closest_px(example, scene):
    """Return how near the goal their policy comes in their own `World`, with nothing of ours."""
    swm, rooms = example.swm, example.Rooms()
    start, _ = rooms.reset(seed=int(scene.removeprefix("seed/")))
    world = swm.World("swm/TwoRoom-v1", 1, (example.SIDE, example.SIDE), disable_env_checker=True)
    solver = swm.solver.CEMSolver(example.fitted("plain", 0), seed=0, **example.CEM)
    prepare = dict.fromkeys(("pixels", "goal"), example.scaled)
    world.set_policy(
        swm.policy.WorldModelPolicy(
            solver, example.PLAN, process={"action": example.SCALER}, transform=prepare
        )
    )
    world.reset(seed=int(scene.removeprefix("seed/")))
    world.envs.envs[0].unwrapped._set_goal_state(rooms.unwrapped.target_position.tolist())
    distances = [float(start["distance"])]
    for _ in range(example.STEPS):
        world.infos["goal"] = start["goal_picture"][None, None]
        with redirect_stdout(StringIO()):
            action = world.policy.get_action(world.infos)
        _, _, reached, _, world.infos = world.envs.step(action)
        distances.append(world.infos["distance_to_target"].item())
        if reached.all():
            break
    return min(distances)


@pytest.mark.filterwarnings("ignore")  # theirs, of Gymnasium and NumPy
def test_without_a_fault_the_loop_is_theirs(example):
    outcomes = attempted(example.create(), "plain", SCENES).outcomes
    distances = [outcome.metrics["closest_px"] for outcome in outcomes]
    assert distances == [closest_px(example, scene) for scene in SCENES]


@pytest.mark.parametrize("fault", ["exposure:scale=0.85", "shift:offset=2/0"])
def test_an_error_at_one_picture_reaches_that_picture_alone(example, fault):
    system, channel = example.create(), fault.partition(":")[0]
    clean = attempted(system, "plain", SCENES).outcomes
    for struck in ("observation", "goal"):
        result = attempted(system, "plain", SCENES, f"{fault}@{struck}")
        assert set(faulted(result)) == {f"{struck}.{channel}"}
        assert result.outcomes != clean


@pytest.mark.filterwarnings("ignore")  # theirs, of Gymnasium
def test_the_cost_of_plans_gets_the_pictures_that_the_taps_struck(example, monkeypatch):
    torch = pytest.importorskip("torch")
    pictures, world_model = [], type(example.fitted("plain", None))
    cost = world_model.get_cost

    def seen(self, info, candidates):
        pictures.append([info[name][0, 0] for name in ("pixels", "goal")])
        return cost(self, info, candidates)

    monkeypatch.setattr(world_model, "get_cost", seen)
    monkeypatch.setattr(example, "STEPS", 1)
    fault, last = "exposure:scale=0.7", []
    for where in ("", fault, f"{fault}@observation", f"{fault}@goal"):
        attempted(example.create(), "plain", SCENES, where)
        last.append(pictures[-1])
    right, shared, observation, goal = last
    assert not any(map(torch.equal, right, shared))
    assert torch.equal(observation[0], shared[0])
    assert torch.equal(observation[1], right[1])
    assert torch.equal(goal[0], right[0])
    assert torch.equal(goal[1], shared[1])


def test_a_calibrated_camera_changes_no_pixel_and_a_rectified_picture_is_its(example, model):
    picture = example.Rooms().reset(seed=20)[0]["picture"][None]
    assert np.array_equal(model.camera(picture, 1.0, np.zeros(2)), picture)
    assert np.array_equal(model.camera(picture, 1.0, np.zeros(2), rectifies=True), picture)
    shown = model.camera(picture, 0.7, np.array([2.0, -1.0]), rectifies=True)
    apart = np.abs(shown.astype(int) - picture)
    assert apart[:, 4:-4, 4:-4].max() <= 1  # what left the picture is lost


def test_the_models_are_fitted(example, tmp_path):
    fit = import_module(Path("stable_worldmodel_fit.py").stem)
    pictures, actions = fit.windows(64)
    assert pictures.shape == (64, 5, 64, 64, 3)
    assert actions.shape == (64, 4, 10)
    for augmented in (False, True):
        fit.fitted(pictures, actions, 0, augmented, epochs=1)
