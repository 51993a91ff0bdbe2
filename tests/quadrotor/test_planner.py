"""The planner: noise, candidates, weights and the two goal costs."""

import pytest
import torch
from faultpath_quadrotor.options import QuadrotorOptions
from faultpath_quadrotor.planners import AutoregressiveSampler, SamplerSettings, Scored
from faultpath_quadrotor.predictors import KinematicIntegrator, PredictorInputs
from faultpath_quadrotor.predictors.rollout import rolling
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import GRAVITY_MPS2, NOMINAL_DRAG_KGPS, RATE_LIMIT_RADPS

from faultpath.core.errors import UserError

SCENES = ["s/0", "s/1", "s/2", "s/3"]


def planner_inputs(mass=1.0):
    state = State.hover(torch.zeros(3, 4, 1), torch.zeros(4, 1))
    column = torch.full((4, 1), mass)
    delivered = {("mass", place): column for place in ("trim", "dynamics", "wind_map")}
    one = torch.ones_like(column)
    delivered |= {("thrust_scale", place): one for place in ("trim", "dynamics")}
    return PredictorInputs(state, delivered | {("wind", "wind_map"): torch.zeros(3, 4, 1)})


def free(positions):
    return torch.ones_like(positions[0])


def replan(planner, inputs, plan, scenes, goal, clearance=free, seen=lambda search: None):
    """Return the plan `[H, 4, S]` that one step makes of another; `seen` gets each search."""
    hover = inputs.hover_thrust
    roll = rolling(KinematicIntegrator(drag=True, drag_kgps=NOMINAL_DRAG_KGPS))
    search = planner.init(plan, hover)
    for iteration in range(planner.iterations):
        commands = planner.propose(search, planner.noise(scenes, 0, 0, iteration))
        rollout = roll(inputs, commands)
        near = clearance(rollout.positions)
        search = planner.update(search, Scored(rollout, commands, near, goal, hover))
        seen(search)
    return search.plan


def test_noise_is_standard_correlated_along_the_horizon_and_of_scene_seed_and_step():
    sampler = AutoregressiveSampler(SamplerSettings(candidates=4096))
    noise = sampler.noise(SCENES, 0, 3)
    assert float(noise[..., 1:].std()) == pytest.approx(1, abs=0.01)
    assert float((noise[1:] * noise[:-1])[..., 1:].mean()) == pytest.approx(0.7, abs=0.01)
    assert torch.equal(sampler.noise(["s/2"], 0, 3)[:, :, 0], noise[:, :, 2])
    for seed, step in ((1, 3), (0, 4)):
        assert not torch.equal(sampler.noise(["s/2"], seed, step)[:, :, 0], noise[:, :, 2])


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
    planner = QuadrotorOptions().build_planner()
    plan = planner.initial_plan(planner_inputs(mass=1.1).hover_thrust)
    assert torch.allclose(plan[:, 0], torch.tensor(1.1 * GRAVITY_MPS2))


@pytest.mark.parametrize("name", ["mppi", "cem"])
def test_plan_moves_towards_the_goal_and_away_from_what_is_close(name):
    planner = QuadrotorOptions(planner=name).build_planner()
    given = planner_inputs()
    plan = planner.initial_plan(torch.full((4,), GRAVITY_MPS2))
    goal = torch.zeros(3, 4)
    goal[2] = torch.tensor([3.0, -3.0, 3.0, -3.0])
    better = replan(planner, given, plan, SCENES, goal)
    change = better[:, 0].mean(0) - GRAVITY_MPS2
    assert (change[[0, 2]] > 0.1).all()
    assert (change[[1, 3]] < -0.1).all()
    # A ceiling just above: the same goal no longer pulls the plan up.
    kept = replan(planner, given, plan, SCENES, goal, clearance=lambda at: 0.3 - at[2])
    assert (kept[:, 0].mean(0)[[0, 2]] < better[:, 0].mean(0)[[0, 2]]).all()


def test_the_cross_entropy_method_closes_in_with_as_many_candidates():
    options = QuadrotorOptions(planner="cem")
    planner, given = options.build_planner(), planner_inputs()
    assert planner.iterations * options.sampling.candidates == QuadrotorOptions().candidates
    goal = torch.tensor([[1.0], [0.5], [0.5]]).expand(3, 4)
    hover = torch.full((4,), GRAVITY_MPS2)
    searched = []
    replan(planner, given, planner.initial_plan(hover), SCENES, goal, seen=searched.append)
    first, *_, last = [search.spread for search in searched]
    assert last.mean() < 0.7 * first.mean()
    with pytest.raises(UserError, match="leave --sampler out"):
        QuadrotorOptions.parse(planner="cem", sampler="mode-preserving")
