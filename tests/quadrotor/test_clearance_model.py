"""The clearance model, bounded and blind to its batch; its data and its fitting."""

import copy
from dataclasses import fields
from pathlib import Path

import pytest
import torch
from faultpath_quadrotor import native
from faultpath_quadrotor.perception.camera import HEIGHT, RANGE_M, WIDTH
from faultpath_quadrotor.perception.clearance import ClearanceModel
from faultpath_quadrotor.perception.labels import (
    HIGHEST_M,
    LOWEST_M,
    between_pixels,
    visible_distance,
)
from faultpath_quadrotor.perception.module import (
    DepthClearance,
    PerceptionSettings,
    in_view,
    near,
)
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.training import clearance_task
from faultpath_quadrotor.training.clearance_task import (
    VALIDATION_FROM,
    ClearanceRecipe,
    ClearanceTask,
    Samples,
    censored_loss,
)

from faultpath.core.errors import UserError

POINTS = 96


def draws(seed: int = 0) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


NEAR_M, UNSEEN_M = PerceptionSettings().near_m, PerceptionSettings().unseen_m


@pytest.fixture(scope="module")
def model() -> ClearanceModel:
    blank = ClearanceModel()
    blank.initialise(draws())
    return blank.eval().requires_grad_(False)


def images(count: int) -> torch.Tensor:
    return torch.rand(count, HEIGHT, WIDTH, generator=draws(1)) * RANGE_M


def points(count: int, each: int) -> torch.Tensor:
    return torch.randn(3, count, each, generator=draws(2)) * 2


def test_clearance_is_bounded_and_is_what_training_sees_between_the_bounds(model: ClearanceModel):
    depth, at = images(6), points(6, POINTS)
    found = model.query(model.encode(depth), at)
    assert found.min() >= LOWEST_M
    assert found.max() <= HIGHEST_M
    free = model.estimate(model.encode_batch(depth), at.movedim(1, 0))
    assert free.max() > HIGHEST_M, "training is not bounded"
    torch.testing.assert_close(found, free.clamp(LOWEST_M, HIGHEST_M), atol=1e-5, rtol=1e-5)


def test_what_no_pixel_can_show_has_little_clearance_and_what_one_shows_keeps_its_own(model):
    generous = copy.deepcopy(model)
    generous.layers[2].bias[-1] += 0.5  # the query network's own bias
    with native.using(native.PORTABLE):
        perception = DepthClearance(generous)
    level = torch.eye(3, dtype=torch.float64)
    perception.capture(images(1), torch.zeros(1, 3, dtype=torch.float64), level[None])
    at = points(1, 960)
    found = perception.query(at, [0])
    free = generous.query(generous.encode(images(1)), at)
    shown = in_view(at) | near(at, NEAR_M)
    capped = ~shown & (free > UNSEEN_M)
    assert capped.sum() > 20
    assert (found[capped] == UNSEEN_M).all()
    assert torch.equal(found[~capped], free[~capped]), "less is kept, inside and outside the view"
    assert (found[shown] > UNSEEN_M).any()


SMALL = ClearanceRecipe(images=1, in_view=16, near_surface=16, around=8)


@pytest.fixture(scope="module")
def collected(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return clearance_task.collect(tmp_path_factory.mktemp("data"), SMALL, workers=0)


@pytest.fixture(scope="module")
def samples(collected: Path) -> Samples:
    return clearance_task.read(collected)


def test_labels_are_those_of_the_stored_images_and_samples_of_recipe_and_scene_alone(samples):
    assert samples.points.shape == (100, 3, SMALL.points)
    for i in (0, 37, 99):
        label = visible_distance(samples.depth_m()[i], samples.points[i]).float()
        assert torch.equal(label, samples.clearance[i])
    assert between_pixels(samples.points.movedim(1, 0)).float().mean() > 0.4
    assert 0.2 < (samples.clearance < 0).float().mean() < 0.5
    scene = load_library("training").scenes[42]
    again = clearance_task.draw(SMALL, scene)
    kept = samples.take((samples.scene == 42).nonzero()[:, 0])
    for field in fields(Samples):
        assert torch.equal(getattr(kept, field.name), getattr(again, field.name)), field.name
    other = clearance_task.draw(SMALL.model_copy(update={"seed": 1}), scene)
    assert not torch.equal(other.points, again.points)


def test_another_recipe_is_refused(collected: Path):
    with pytest.raises(UserError, match="collected with another 'seed'"):
        clearance_task.collect(collected.parent, SMALL.model_copy(update={"seed": 9}))
    with pytest.raises(UserError, match="collected with another 'settings'"):
        clearance_task.collect(collected.parent, SMALL.model_copy(update={"images": 2}))


def test_validation_scenes_are_never_trained_on(samples: Samples):
    task = ClearanceTask(0, Path(), SMALL)
    task.use(samples)
    assert task._training.scene.max() < VALIDATION_FROM <= task._validation.scene.min()
    assert task.count + len(task._validation) == 100


def test_beyond_a_bound_that_the_truth_is_at_an_estimate_costs_nothing():
    truth = torch.tensor([HIGHEST_M, LOWEST_M, 0.5])
    right = torch.tensor([HIGHEST_M + 1, LOWEST_M - 1, 0.5])
    assert censored_loss(right, truth) == 0
    for i, wrong in enumerate((0.9, -0.2, 1.5)):
        changed = right.clone()
        changed[i] = wrong
        assert censored_loss(changed, truth) > 0
