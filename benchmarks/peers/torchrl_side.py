"""torchrl (Meta): its `MPPIPlanner` in an environment of a model, with a cheap goal and speed cost.

The planner draws from a standard normal distribution, which the environment scales to commands. One
refinement that takes all candidates is the update of MPPI; the library's own example makes eleven.
"""

from typing import Any

from tensordict import TensorDict
from torch import nn
from torchrl.data import Bounded, Composite, Unbounded
from torchrl.envs.model_based import ModelBasedEnvBase
from torchrl.modules import MPPIPlanner

from benchmarks import planning
from benchmarks.peers import batched
from benchmarks.side import Side, check_same


class World(nn.Module):
    """WM-A under scaled commands, and the reward of where it leads."""

    def __init__(self, model: batched.BatchModel) -> None:
        super().__init__()
        self.model = model
        self.centre, self.sigma, low, high = batched.actions()
        self.low, self.high = (low - self.centre) / self.sigma, (high - self.centre) / self.sigma

    def forward(self, tensordict: TensorDict) -> TensorDict:
        """Write state and reward, `[K, 50]` and `[K, 1]`."""
        command = self.centre + self.sigma * tensordict["action"]
        state = self.model(tensordict["state"], command)
        return tensordict.update({"state": state, "reward": -batched.cost(state)[:, None]})


class Environment(ModelBasedEnvBase):
    def __init__(self, world: World) -> None:
        super().__init__(world)
        self.state_spec = Composite(state=Unbounded((batched.STATE,)))
        self.observation_spec = Composite(state=Unbounded((batched.STATE,)))
        self.action_spec = Bounded(world.low, world.high)
        self.reward_spec = Unbounded((1,))

    def _reset(self, tensordict: Any, **_: Any) -> TensorDict:
        return TensorDict({"state": batched.initial()})


class Return(nn.Module):
    """Sum of the rewards, where the planner looks for the advantage."""

    def forward(self, tensordict: TensorDict) -> TensorDict:
        rewards = tensordict["next", "reward"]
        return tensordict.set("advantage", rewards.sum(-2, keepdim=True).expand_as(rewards))


def planning_step() -> Side:
    model = batched.BatchModel()
    check_same(batched.positions(model), planning.positions(), 1e-3)
    planner = MPPIPlanner(
        Environment(World(model)),
        Return(),
        temperature=0.1,  # it takes exp(temperature * return) as it stands, which 1 would underflow
        planning_horizon=planning.HORIZON,
        optim_steps=1,
        num_candidates=planning.CANDIDATES,
        top_k=planning.CANDIDATES,
    )
    state = TensorDict({"state": batched.initial()})
    return Side(lambda: planner.planning(state))
