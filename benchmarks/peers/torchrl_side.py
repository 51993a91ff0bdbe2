"""torchrl's `MPPIPlanner` on a model-based environment, one round of optimisation a replan.

Value and cost are as cheap as they can be: the sum of rewards, and the distance to the goal with
the penalty on speed. Every candidate counts, as in our planner (`top_k` of all).
"""

import warnings

import torch
from tensordict import TensorDict, TensorDictBase
from tensordict.nn import TensorDictModule
from torch import Tensor, nn
from torchrl.data import Bounded, Composite, Unbounded
from torchrl.envs import ModelBasedEnvBase
from torchrl.modules import MPPIPlanner, WorldModelWrapper

from benchmarks import planning
from benchmarks.peers import rows
from benchmarks.side import Side, check_same


def replan() -> Side:
    """One call of the planner."""
    warnings.simplefilter("ignore")
    model = rows.RowsModel()
    check_same(rows.positions(model), planning.positions(), 1e-3)
    world = WorldModelWrapper(
        TensorDictModule(_Scaled(model), ["state", "action"], ["state"]),
        TensorDictModule(_Reward(), ["state"], ["reward"]),
    )
    planner = MPPIPlanner(
        _World(world),
        _Return(),
        temperature=1.0,
        planning_horizon=planning.HORIZON,
        optim_steps=1,
        num_candidates=planning.CANDIDATES,
        top_k=planning.CANDIDATES,
    )
    blank = torch.zeros(1, dtype=torch.bool)
    given = TensorDict({"state": rows.initial(), "done": blank, "terminated": blank}, batch_size=[])
    return Side(lambda: planner(given.clone()))


class _Scaled(nn.Module):
    """Turns the planner's standard normal actions into commands about hover."""

    def __init__(self, step: rows.RowsModel) -> None:
        super().__init__()
        self.step = step
        for name, value in zip(("centre", "sigma", "low", "high"), rows.actions(), strict=True):
            self.register_buffer(name, value)

    def forward(self, state: Tensor, action: Tensor) -> Tensor:
        return self.step(state, torch.clamp(self.centre + self.sigma * action, self.low, self.high))


class _Reward(nn.Module):
    def forward(self, state: Tensor) -> Tensor:
        return -rows.cost(state)[..., None]


class _Return(nn.Module):
    """The advantage of a candidate: its summed reward over the horizon."""

    def forward(self, rollouts: TensorDictBase) -> TensorDictBase:
        total = rollouts["next", "reward"].sum(-2, keepdim=True)
        return rollouts.set("advantage", total.expand_as(rollouts["next", "reward"]))


class _World(ModelBasedEnvBase):
    def __init__(self, world: WorldModelWrapper) -> None:
        super().__init__(world, device="cpu", batch_size=torch.Size([]))
        self.observation_spec = Composite(state=Unbounded((rows.STATE,)))
        self.state_spec = Composite(state=Unbounded((rows.STATE,)))
        self.action_spec = Bounded(-6.0, 6.0, (4,))
        self.reward_spec = Unbounded((1,))

    def _reset(self, tensordict: TensorDictBase) -> TensorDictBase:
        return TensorDict({"state": rows.initial()}, batch_size=[])
