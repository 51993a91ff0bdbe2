"""The planner that keeps its modes apart."""

import torch
from planning_toys import Even

from faultpath.quadrotor.planners import (
    AutoregressiveSampler,
    BundledSampler,
    SamplerSettings,
    WithinBundle,
    weighted_mean,
)
from faultpath.quadrotor.planners.modes import BUNDLES, SHARED

SETTINGS = SamplerSettings(candidates=512)


def _bundles() -> torch.Tensor:
    noise = BundledSampler(AutoregressiveSampler(SETTINGS)).noise(["a", "b"], 0, 3)
    return noise.unflatten(-1, (BUNDLES, -1))


def test_a_candidate_alone_is_distributed_as_before() -> None:
    drawn = torch.cat(
        [
            BundledSampler(AutoregressiveSampler(SETTINGS)).noise(["a"], 0, step)
            for step in range(40)
        ],
        dim=-1,
    ).unflatten(-1, (40, BUNDLES, -1))[..., 1:, 1:]  # the first bundle's centre is the plan
    assert abs(float(drawn.var()) - 1) < 0.1
    assert abs(float(drawn.mean())) < 0.05


def test_candidates_of_a_bundle_stand_together() -> None:
    apart = _bundles()[..., 1:, :]
    spread = apart[..., 1:].var(dim=-1).mean()
    torch.testing.assert_close(spread, torch.tensor(1 - SHARED), atol=0.05, rtol=0)


def test_the_plan_itself_is_a_candidate() -> None:
    assert torch.count_nonzero(_bundles()[..., 0, 0]) == 0


def test_the_plan_is_the_mean_of_one_bundle() -> None:
    cost = torch.full((1, 512), 9.0)
    cost[0, 64:128], cost[0, 192:256] = 1.0, 1.1  # two ways round, the first a little better
    commands = torch.zeros(1, 4, 1, 512)
    commands[..., 64:128], commands[..., 192:256] = 1.0, -1.0
    weights = WithinBundle(Even(0.5)).weights(cost)
    torch.testing.assert_close(weights.sum(), torch.tensor(1.0))
    torch.testing.assert_close(weighted_mean(commands, weights), torch.ones(1, 4, 1))
    everyone = weighted_mean(commands, Even(0.5).weights(cost))
    assert abs(float(everyone[0, 0, 0])) < 0.2  # the mean over all lies between the two
