"""The planner: noise, candidates, weights and the two goal costs."""

import numpy as np
import pytest
import torch
from faultpath_quadrotor.options import QuadrotorOptions
from faultpath_quadrotor.planners import (
    AutoregressiveSampler,
    BundledSampler,
    CostWeights,
    NavigationCost,
    SamplerSettings,
    Scored,
)
from faultpath_quadrotor.planners.mppi import softmax
from faultpath_quadrotor.planners.sampler import standard_normals
from faultpath_quadrotor.predictors import Calibration, PredictorInputs
from faultpath_quadrotor.predictors.rollout import Rollout
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import GRAVITY_MPS2, RATE_LIMIT_RADPS
from planning_toys import replan
from scipy import stats

from faultpath.core.streams import generator

SCENES = ["s/0", "s/1", "s/2", "s/3"]


def planner_inputs(scenes=4, mass=1.0):
    state = State.hover(torch.zeros(3, scenes, 1), torch.zeros(scenes, 1))
    column = torch.full((scenes, 1), mass)
    calibration = Calibration(column, torch.ones_like(column))
    return PredictorInputs(state, calibration, calibration, column, torch.zeros(3, scenes, 1))


def test_noise_is_standard_and_correlated_along_the_horizon():
    sampler = AutoregressiveSampler(SamplerSettings(candidates=4096))
    noise = sampler.noise(SCENES, 0, 3)[..., 1:]
    assert float(noise.std()) == pytest.approx(1, abs=0.01)
    neighbours = (noise[1:] * noise[:-1]).mean()
    assert float(neighbours) == pytest.approx(0.7, abs=0.01)


def test_noise_belongs_to_scene_seed_and_step():
    sampler = AutoregressiveSampler()
    noise = sampler.noise(SCENES, 0, 3)
    assert torch.equal(sampler.noise(["s/2"], 0, 3)[:, :, 0], noise[:, :, 2])
    assert not torch.equal(sampler.noise(["s/2"], 1, 3)[:, :, 0], noise[:, :, 2])
    assert not torch.equal(sampler.noise(["s/2"], 0, 4)[:, :, 0], noise[:, :, 2])


def test_candidates_are_bounded_evenly_around_hover():
    sampler = AutoregressiveSampler(SamplerSettings(thrust_sigma=1.0, rate_sigma_radps=(9, 9, 9)))
    hover = torch.full((4,), 8.0)
    plan = torch.zeros(20, 4, 4)
    plan[:, 0] = 8.0
    candidates = sampler.candidates(plan, hover, sampler.noise(SCENES, 0, 0))
    assert float(candidates[:, 0].min()) == 0
    assert float(candidates[:, 0].max()) == 16
    assert float(candidates[:, 0].mean()) == pytest.approx(8, abs=0.1)
    for axis, limit in enumerate(RATE_LIMIT_RADPS):
        assert float(candidates[:, axis + 1].abs().max()) == limit


def test_trim_follows_the_supplied_calibration():
    """The hover centre moves with m~ and T~; nothing else of the sampler does."""
    planner = QuadrotorOptions().build_planner()
    wrong = planner_inputs(mass=1.1)
    plan = planner.initial_plan(wrong.trim.hover_thrust(GRAVITY_MPS2)[:, 0])
    assert torch.allclose(plan[:, 0], torch.tensor(1.1 * GRAVITY_MPS2))


def scored(positions, goal):
    zero = torch.zeros_like(positions)
    final = State(positions[:, :, -1], zero[:, :, -1], torch.zeros(3, 3, 1, 2), zero[:, :, -1])
    return Scored(
        Rollout(positions, zero, final), torch.zeros(3, 4, 1, 2), zero[0], goal, torch.ones(1)
    )


@pytest.mark.parametrize(("running", "expected"), [(0.0, 0.2), (0.35, 0.27), (1.0, 0.4)])
def test_stiffness_is_the_share_of_the_way_in_the_distance(running, expected):
    """A dip that is mostly made good by the end costs little where only the end counts."""
    straight = torch.zeros(3, 1, 3)
    dip = straight.clone()
    dip[2, 0, 1] = -1.0
    dip[2, 0, 2] = -0.2
    case = scored(torch.stack([straight, dip], dim=-1), torch.zeros(3, 1))
    cost = NavigationCost(CostWeights(goal=1.0, running=running, heading=0.0, thrust_effort=0.0))
    found = cost(case)[0]
    assert (found[1] - found[0]).item() == pytest.approx(expected, rel=1e-3)


def test_what_hits_something_does_not_change_how_the_rest_is_weighed():
    cost = torch.tensor([[0.0, 1.0, 2.0, 3.0, 100.0, 100.0, 100.0, 100.0]])
    worse = cost.clone()
    worse[0, 4:] = 1e6
    weights = softmax(cost, 0.5)
    assert torch.equal(softmax(worse, 0.5), weights)
    spread = 0.5 * cost[0, :4].std()
    assert (weights[0, 0] / weights[0, 1]).log().item() == pytest.approx(1 / spread.item())


def test_bundles_are_neighbours_and_each_candidate_is_distributed_as_before():
    settings = SamplerSettings(candidates=4096)
    plain = AutoregressiveSampler(settings).noise(SCENES, 0, 3)
    bundled = BundledSampler(settings).noise(SCENES, 0, 3)
    assert float(bundled[..., 1:].std()) == pytest.approx(float(plain[..., 1:].std()), abs=0.05)
    third = bundled.unflatten(-1, (8, -1))[..., 3, :]
    centre, others = third[..., :1], third[..., 1:]
    assert float((centre * others).mean()) == pytest.approx(0.5**0.5, abs=0.1)


def test_plan_moves_towards_the_goal_and_away_from_what_is_close():
    planner = QuadrotorOptions().build_planner()
    given = planner_inputs()
    plan = planner.initial_plan(torch.full((4,), GRAVITY_MPS2))
    goal = torch.zeros(3, 4)
    goal[2] = torch.tensor([3.0, -3.0, 3.0, -3.0])
    better = replan(planner, given, plan, SCENES, goal=goal)
    change = better[:, 0].mean(0) - GRAVITY_MPS2
    assert (change[[0, 2]] > 0.1).all()
    assert (change[[1, 3]] < -0.1).all()
    # A ceiling just above: the same goal no longer pulls the plan up.
    kept = replan(planner, given, plan, SCENES, goal=goal, clearance=lambda at: 0.3 - at[2])
    assert (kept[:, 0].mean(0)[[0, 2]] < better[:, 0].mean(0)[[0, 2]]).all()


def test_normals_are_standard_normal():
    normals = torch.cat(
        [standard_normals(generator("test", "s", 0, step), 40960) for step in range(50)]
    )
    assert normals.isfinite().all()
    grid = normals.double().numpy()
    assert stats.kstest(grid[::10], "norm").pvalue > 0.001
    assert float(grid.std()) == pytest.approx(1, abs=0.002)
    assert float((grid**4).mean()) == pytest.approx(3, abs=0.03)
    assert 4.5 < abs(grid).max() < 7
    # The two normals of a pair, and neighbours in the stream, do not know of each other.
    for lag in (1, 20480):
        assert abs(np.corrcoef(grid[:-lag], grid[lag:])[0, 1]) < 0.003
