"""The clearance model: bounded, blind to its batch, and encoded once a capture."""

import copy

import pytest
import torch
from faultpath_quadrotor import native
from faultpath_quadrotor.perception.camera import HEIGHT, RANGE_M, WIDTH
from faultpath_quadrotor.perception.clearance import ClearanceModel
from faultpath_quadrotor.perception.labels import HIGHEST_M, LOWEST_M
from faultpath_quadrotor.perception.seen import DepthClearance, PerceptionSettings, in_view, near

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


def points(count: int, each: int = POINTS) -> torch.Tensor:
    return torch.randn(3, count, each, generator=draws(2)) * 2


def test_a_scenes_code_has_the_same_bits_in_any_batch(model: ClearanceModel):
    depth = images(40)
    together = model.encode(depth)
    assert together.shape == (64, 40)
    for chosen in ([7], [39, 0, 20], list(range(3, 36))):
        assert torch.equal(model.encode(depth[chosen]), together[:, chosen])


@pytest.mark.parametrize("each", [POINTS, 2560 + 32])
def test_a_scenes_clearance_has_the_same_bits_in_any_chunk(model: ClearanceModel, each: int):
    code, at = model.encode(images(13)), points(13, each)
    together = model.query(code, at)
    assert together.shape == (13, each)
    for chosen in ([5], [12, 1], [0, 3, 4, 6]):
        alone = model.query(code[:, chosen].contiguous(), at[:, chosen].contiguous())
        assert torch.equal(alone, together[chosen])


def test_clearance_is_bounded_and_is_what_training_sees_between_the_bounds(model: ClearanceModel):
    depth, at = images(6), points(6)
    found = model.query(model.encode(depth), at)
    assert found.min() >= LOWEST_M
    assert found.max() <= HIGHEST_M
    free = model.estimate(model.encode_batch(depth), at.movedim(1, 0))
    assert free.max() > HIGHEST_M, "training is not bounded"
    torch.testing.assert_close(found, free.clamp(LOWEST_M, HIGHEST_M), atol=1e-5, rtol=1e-5)


def test_what_no_pixel_can_show_has_little_clearance_and_what_one_shows_keeps_its_own(
    model: ClearanceModel,
):
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
