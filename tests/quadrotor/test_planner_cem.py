"""The cross-entropy method: what it fits, where it stops, and what it repeats."""

import pytest
import torch

from faultpath.quadrotor.planners import (
    CEM,
    AutoregressiveSampler,
    CEMSettings,
    NavigationCost,
    SamplerSettings,
    Scored,
    TerminalGoal,
)
from faultpath.quadrotor.predictors.rollout import Rollout
from faultpath.quadrotor.state import State

SCENES = ("a", "b")
HOVER = torch.full((2,), 9.81)


class FarFromHover(NavigationCost):
    """Least where the first thrust is 2 N above the hover, whatever is rolled out."""

    def __init__(self):
        super().__init__(TerminalGoal())

    def __call__(self, scored):
        return (scored.commands[0, 0] - scored.hover[:, None] - 2.0).abs()


def cem(**settings):
    sampler = AutoregressiveSampler(SamplerSettings(candidates=512, horizon=4))
    return CEM(sampler, FarFromHover(), CEMSettings(**settings))


def scored(commands):
    none = torch.zeros(3, 2, 4, commands.shape[-1])
    end = State(none[:, :, 0], none[:, :, 0], torch.zeros(3, 3, 2, 512), none[:, :, 0])
    return Scored(Rollout(none, none, end), commands, none[0], torch.zeros(3, 2), HOVER)


def search(planner, seed=0, scenes=SCENES):
    now = planner.init(planner.initial_plan(HOVER[: len(scenes)]), HOVER[: len(scenes)])
    for iteration in range(planner.iterations):
        commands = planner.propose(now, planner.noise(scenes, seed, 0, iteration))
        now = planner.update(now, scored(commands))
    return now


def test_iterations_find_what_one_proposal_does_not() -> None:
    once, often = (search(cem(iterations=count, momentum=0.0)) for count in (1, 6))
    best = HOVER + 2.0
    assert ((often.plan[0, 0] - best).abs() < 0.02).all()
    assert ((often.plan[0, 0] - best).abs() < (once.plan[0, 0] - best).abs()).all()
    assert (often.spread[0, 0] < once.spread[0, 0]).all()


def test_plan_and_spread_are_those_of_the_elites() -> None:
    planner = cem(iterations=1, elites=8, momentum=0.0, least_spread=0.0)
    now = planner.init(planner.initial_plan(HOVER), HOVER)
    commands = planner.propose(now, planner.noise(SCENES, 0, 0))
    after = planner.update(now, scored(commands))
    order = (commands[0, 0, 1] - HOVER[1] - 2.0).abs().argsort()[:8]
    torch.testing.assert_close(after.plan[..., 1], commands[:, :, 1, order].mean(-1))
    torch.testing.assert_close(after.spread[..., 1], commands[:, :, 1, order].std(-1, correction=0))


def test_the_spread_keeps_its_floor_and_momentum_what_was() -> None:
    floored = search(cem(iterations=9, least_spread=0.5))
    sigma = 0.22 * HOVER
    torch.testing.assert_close(floored.spread[0, 0], 0.5 * sigma)
    calm = search(cem(iterations=1, momentum=0.9))
    quick = search(cem(iterations=1, momentum=0.0))
    assert ((calm.plan[0, 0] - HOVER).abs() < 0.2 * (quick.plan[0, 0] - HOVER).abs()).all()


def test_commands_stay_within_the_limits() -> None:
    planner = cem()
    now = planner.init(planner.initial_plan(HOVER), HOVER)
    wide = type(now)(now.plan, now.hover, 100 * now.spread)
    commands = planner.propose(wide, planner.noise(SCENES, 0, 0))
    assert float(commands[:, 0].min()) == 0.0
    assert float(commands[:, 0].max()) == pytest.approx(2 * 9.81)


def test_iterations_draw_apart_and_a_scene_alone_the_same() -> None:
    planner = cem()
    first, second = (planner.noise(SCENES, 0, 3, iteration) for iteration in (0, 1))
    assert not torch.equal(first, second)
    assert torch.equal(planner.noise(SCENES[1:], 0, 3, 1)[:, :, 0], second[:, :, 1])


def test_ties_fall_to_the_first_and_every_plan_repeats() -> None:
    class Flat(FarFromHover):
        def __call__(self, scored):
            return torch.zeros(2, 512)

    sampler = AutoregressiveSampler(SamplerSettings(candidates=512, horizon=4))
    planner = CEM(sampler, Flat(), CEMSettings(iterations=1, elites=2, momentum=0.0))
    now = planner.init(planner.initial_plan(HOVER), HOVER)
    commands = planner.propose(now, planner.noise(SCENES, 0, 0))
    after = planner.update(now, scored(commands))
    torch.testing.assert_close(after.plan, commands[..., :2].mean(-1))
    assert torch.equal(search(cem()).plan, search(cem()).plan)
