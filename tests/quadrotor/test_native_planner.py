"""Compiled noise, candidates, costs, means and clearance are the portable ones to rounding."""

import pytest
import torch

from faultpath.quadrotor import native, so3
from faultpath.quadrotor.models import clearance_model
from faultpath.quadrotor.native.clearance import CompiledDepthClearance
from faultpath.quadrotor.native.costs import CompiledCost, CompiledMean, CompiledTemperature
from faultpath.quadrotor.native.encoder import CompiledEncoder
from faultpath.quadrotor.native.sampling import CompiledSampler
from faultpath.quadrotor.perception import ClearanceModel, DepthClearance
from faultpath.quadrotor.perception.camera import CaptureFrame
from faultpath.quadrotor.planner import (
    AutoregressiveSampler,
    CostWeights,
    GoalCost,
    NavigationCost,
    RunningGoal,
    SamplerSettings,
    ScaledTemperature,
    Scored,
    TerminalGoal,
    weighted_mean,
)
from faultpath.quadrotor.rollout import Rollout
from faultpath.quadrotor.state import State

SCENES = ("a", "b", "c")


@pytest.fixture(params=native.available())
def kernels(request: pytest.FixtureRequest) -> native.Kernels:
    return native.load(request.param)


@pytest.fixture
def stream() -> torch.Generator:
    return torch.Generator().manual_seed(0)


def close(mine: torch.Tensor, reference: torch.Tensor, tolerance: float = 1e-5) -> None:
    torch.testing.assert_close(mine, reference, rtol=tolerance, atol=tolerance)


@pytest.mark.parametrize(("candidates", "horizon"), [(64, 20), (64, 7), (16, 1)])
def test_noise_is_the_portable_one(kernels: native.Kernels, candidates: int, horizon: int) -> None:
    sampler = AutoregressiveSampler(SamplerSettings(candidates=candidates, horizon=horizon))
    compiled = CompiledSampler(kernels, sampler)
    close(compiled.noise(SCENES, 3, 5), sampler.noise(SCENES, 3, 5))


def test_candidates_are_the_portable_ones(kernels: native.Kernels, stream: torch.Generator) -> None:
    settings = SamplerSettings(candidates=64, thrust_sigma=1.0, rate_sigma_radps=(9, 9, 9))
    sampler = AutoregressiveSampler(settings)
    plan = torch.randn(20, 4, 3, generator=stream)
    hover = torch.tensor([4.0, 9.0, 15.0])
    noise = torch.randn(20, 4, 3, 64, generator=stream)
    compiled = CompiledSampler(kernels, sampler).candidates(plan, hover, noise.clone())
    close(compiled, sampler.candidates(plan, hover, noise))


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


@pytest.mark.parametrize("candidates", [64, 50])
@pytest.mark.parametrize("goal", [TerminalGoal(), RunningGoal()], ids=["terminal", "running"])
def test_costs_are_the_portable_ones(
    kernels: native.Kernels, goal: GoalCost, candidates: int, stream: torch.Generator
) -> None:
    cost = NavigationCost(goal, CostWeights())
    case = scored(stream, candidates)
    close(CompiledCost(kernels, cost)(case), cost(case))


@pytest.mark.parametrize("term", ["goal", "risk", "hit", "speed", "heading", "rate_effort"])
def test_every_term_of_the_cost_counts(
    kernels: native.Kernels, term: str, stream: torch.Generator
) -> None:
    case = scored(stream, 16)
    without = CostWeights(**{term: 0.0})
    whole = CompiledCost(kernels, NavigationCost(TerminalGoal()))(case)
    rest = CompiledCost(kernels, NavigationCost(TerminalGoal(), without))(case)
    assert not torch.allclose(whole, rest)
    close(rest, NavigationCost(TerminalGoal(), without)(case))


@pytest.mark.parametrize("candidates", [512, 50])
@pytest.mark.parametrize("size", [1e-6, 1.0, 300.0])
def test_weights_are_the_portable_ones(
    kernels: native.Kernels, candidates: int, size: float, stream: torch.Generator
) -> None:
    cost = size * torch.randn(3, candidates, generator=stream).exp()
    temperature = ScaledTemperature(0.08)
    mine = CompiledTemperature(kernels, temperature).weights(cost)
    close(mine, temperature.weights(cost), 1e-4)
    close(mine.sum(1), torch.ones(3))


@pytest.mark.parametrize("lost", [1, 200, 500, 512])
def test_a_cost_that_is_no_number_spoils_the_scene_as_in_torch(
    kernels: native.Kernels, lost: int, stream: torch.Generator
) -> None:
    cost = torch.randn(2, 512, generator=stream).exp()
    cost[0, torch.randperm(512, generator=stream)[:lost]] = torch.nan
    temperature = ScaledTemperature(0.08)
    mine = CompiledTemperature(kernels, temperature).weights(cost)
    assert mine[0].isnan().all()
    torch.testing.assert_close(
        mine, temperature.weights(cost), rtol=1e-4, atol=1e-4, equal_nan=True
    )


def test_what_is_no_number_stays_so_in_candidates_and_costs(
    kernels: native.Kernels, stream: torch.Generator
) -> None:
    sampler = AutoregressiveSampler(SamplerSettings(candidates=16))
    plan = torch.zeros(20, 4, 2)
    plan[3, :, 1] = torch.nan
    noise = torch.randn(20, 4, 2, 16, generator=stream)
    hover = torch.full((2,), 9.8)
    mine = CompiledSampler(kernels, sampler).candidates(plan, hover, noise.clone())
    assert torch.equal(mine.isnan(), sampler.candidates(plan, hover, noise).isnan())

    case = scored(stream, 16)
    case.clearance[1, 4, 3] = torch.nan
    cost = NavigationCost(TerminalGoal())
    assert torch.equal(CompiledCost(kernels, cost)(case).isnan(), cost(case).isnan())


def test_tiny_weights_are_none(kernels: native.Kernels) -> None:
    cost = torch.linspace(0, 1e5, 512)[None]
    weights = CompiledTemperature(kernels, ScaledTemperature(0.001)).weights(cost)
    assert (weights[weights > 0] > 1e-36).all()


@pytest.mark.parametrize("candidates", [64, 50])
def test_means_are_the_portable_ones(
    kernels: native.Kernels, candidates: int, stream: torch.Generator
) -> None:
    commands = torch.randn(20, 4, 3, candidates, generator=stream)
    weight = torch.randn(3, candidates, generator=stream).softmax(1)
    close(CompiledMean(kernels)(commands, weight), weighted_mean(commands, weight))


@torch.inference_mode()
def test_clearance_is_the_portable_one(kernels: native.Kernels, stream: torch.Generator) -> None:
    model = clearance_model()
    portable, compiled = DepthClearance(model), CompiledDepthClearance(kernels, model)
    depth = 6 * torch.rand(4, 36, 64, generator=stream)
    position = torch.randn(4, 3, generator=stream)
    rotation = so3.exp(torch.randn(3, 4, generator=stream)).movedim(-1, 0)
    ahead = torch.randn(3, 2, 320, generator=stream)
    ahead[0] = 3 * ahead[0].abs()  # most of them in view
    chosen = [2, 0]
    frame = CaptureFrame(position[chosen].T, rotation[chosen].movedim(0, -1))
    points = frame.to_world(ahead)
    for clearance in (portable, compiled):
        clearance.capture(depth, position, rotation)
    mine, reference = (c.query(points, chosen) for c in (compiled, portable))
    close(mine, reference, 1e-4)
    assert reference.std() > 0.1


@torch.inference_mode()
def test_codes_are_the_portable_ones(kernels: native.Kernels, stream: torch.Generator) -> None:
    model = clearance_model()
    depth = 6 * torch.rand(5, 36, 64, generator=stream)
    depth[:, 10:20, :30] = 0.0
    codes = CompiledEncoder(kernels, model)(depth)
    close(codes, model.encode(depth), 1e-4)
    assert torch.equal(codes[:, 3:], CompiledEncoder(kernels, model)(depth[3:]))
    depth[2, 7, 7] = torch.nan
    lost = CompiledEncoder(kernels, model)(depth).isnan()
    assert torch.equal(lost, model.encode(depth).isnan())
    assert lost[:, 2].all()


def test_a_query_before_the_first_image_is_refused(kernels: native.Kernels) -> None:
    with pytest.raises(RuntimeError, match="capture"):
        CompiledDepthClearance(kernels, ClearanceModel()).query(torch.zeros(3, 1, 32), [0])
