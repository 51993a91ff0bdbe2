"""Compiled noise, costs and clearance are the portable ones to rounding."""

from collections.abc import Callable
from typing import Any

import pytest
import torch
from faultpath_quadrotor import native, so3
from faultpath_quadrotor.models import clearance_model
from faultpath_quadrotor.perception import DepthClearance
from faultpath_quadrotor.planners import (
    AutoregressiveSampler,
    CostWeights,
    NavigationCost,
    SamplerSettings,
    Scored,
)
from faultpath_quadrotor.planners.base import mean
from faultpath_quadrotor.planners.mppi import softmax
from faultpath_quadrotor.predictors.rollout import Rollout
from faultpath_quadrotor.state import State
from kernel_sets import FUSED

SCENES = ("a", "b", "c")


def both(isa: str, of: Callable[..., Any], *given: object) -> tuple[Any, Any]:
    """Return what a call gives with one set of kernels, and on the portable path."""
    with native.using(isa):
        ours = of(*given)
    with native.using(native.PORTABLE):
        return ours, of(*given)


@pytest.fixture
def stream() -> torch.Generator:
    return torch.Generator().manual_seed(0)


def close(mine: torch.Tensor, reference: torch.Tensor, tolerance: float = 1e-5) -> None:
    torch.testing.assert_close(mine, reference, rtol=tolerance, atol=tolerance)


@pytest.mark.parametrize(("candidates", "horizon"), [(64, 20), (64, 7), (16, 1)])
def test_noise_is_the_portable_one(isa: str, candidates: int, horizon: int) -> None:
    sampler = AutoregressiveSampler(SamplerSettings(candidates=candidates, horizon=horizon))
    close(*both(isa, sampler.noise, SCENES, 3, 5))


def scored(stream: torch.Generator, candidates: int) -> Scored:
    def draw(*shape: int) -> torch.Tensor:
        return torch.randn(*shape, generator=stream)

    positions, velocities = 3 * draw(3, 3, 20, candidates), 3 * draw(3, 3, 20, candidates)
    rotation = so3.exp(draw(3, 3, candidates))
    final = State(positions[:, :, -1], velocities[:, :, -1], rotation, draw(3, 3, candidates))
    commands = draw(20, 4, 3, candidates)
    return Scored(
        rollout=Rollout(positions, velocities, final),
        commands=commands,
        clearance=0.3 + 0.3 * draw(3, 20, candidates),
        goal=5 * draw(3, 3),
        hover=9 + draw(3),
    )


@pytest.mark.parametrize(("running", "candidates"), [(0.0, 64), (0.35, 50), (1.0, 64)])
def test_costs_are_the_portable_ones(isa, running, candidates, stream):
    cost = NavigationCost(CostWeights(running=running))
    close(*both(isa, cost, scored(stream, candidates)))


@torch.inference_mode()
def test_clearance_is_the_portable_one(isa: str, stream: torch.Generator) -> None:
    model = clearance_model()
    compiled, portable = both(isa, DepthClearance, model)
    assert compiled.queries is not None is portable.queries
    depth = 6 * torch.rand(4, 36, 64, generator=stream)
    position = torch.randn(4, 3, generator=stream)
    rotation = so3.exp(torch.randn(3, 4, generator=stream)).movedim(-1, 0)
    ahead = torch.randn(3, 2, 320, generator=stream)
    ahead[0] = 3 * ahead[0].abs()  # most of them in view
    chosen = [2, 0]
    eye, axes = position[chosen].T, rotation[chosen].movedim(0, -1)
    points = so3.rotate(axes[..., None], ahead) + eye[..., None]
    for clearance in (portable, compiled):
        clearance.capture(depth, position, rotation)
    mine, reference = (c.query(points, chosen) for c in (compiled, portable))
    close(mine, reference, 1e-4)
    assert reference.std() > 0.1


@torch.inference_mode()
def test_codes_are_the_portable_ones(isa: str, stream: torch.Generator) -> None:
    model = clearance_model()
    depth = 6 * torch.rand(5, 36, 64, generator=stream)
    depth[:, 10:20, :30] = 0.0
    encode = both(isa, DepthClearance, model)[0].encoder
    assert encode is not None
    close(encode(depth), model.encode(depth), 1e-4)
    depth[2, 7, 7] = torch.nan
    lost = encode(depth).isnan()
    assert torch.equal(lost, model.encode(depth).isnan())
    assert lost[:, 2].all()


@pytest.mark.parametrize("candidates", [16, 512])
def test_weights_and_means_are_the_portable_ones(isa: str, candidates: int, stream) -> None:
    cost = 3 * torch.randn(3, candidates, generator=stream)
    cost[0, 3:9] = cost[0].median()  # as many cost the same as the half may need
    commands = torch.randn(20, 4, 3, candidates, generator=stream)
    weights, reference = both(isa, softmax, cost, 0.1)
    close(weights, reference)
    close(*both(isa, mean, commands, reference))
    cost[1] = 2.0
    cost[2, 5] = torch.nan
    even, lost = both(isa, softmax, cost, 0.1)[0][1:]
    assert torch.equal(even, torch.full_like(even, 1 / candidates))
    assert lost.isnan().all()


def test_sets_that_fuse_agree_on_weights_of_candidates_that_are_hopeless(stream) -> None:
    cost = 1e4 * torch.rand(2, 64, generator=stream)
    cost[0, :32] = torch.linspace(0, 1, 32)
    weights = []
    for isa in FUSED:
        with native.using(isa):
            weights.append(softmax(cost, 0.1))
    assert (weights[0] > 0).all()
    assert all(torch.equal(weights[0], other) for other in weights[1:])
