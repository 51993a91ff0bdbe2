"""torchrl's `MPPIPlanner` on a model-based environment, one round of optimisation a replan.

Value and cost are as cheap as they can be: the sum of rewards, and the distance to the goal with
the penalty on speed. Every candidate counts, as in our planner (`top_k` of all).
"""

import warnings
from collections.abc import Sequence

import torch
from tensordict import TensorDict, TensorDictBase
from tensordict.nn import TensorDictModule
from torch import Tensor, nn
from torchrl.data import Bounded, Composite, Unbounded
from torchrl.envs import ModelBasedEnvBase
from torchrl.modules import MPPIPlanner, WorldModelWrapper
from typing_extensions import override

from benchmarks import problem
from benchmarks.peers import rows
from benchmarks.side import Side
from faultpath.quadrotor.planner import CostWeights, SamplerSettings
from faultpath.quadrotor.vehicle import GRAVITY_MPS2, RATE_LIMIT_RADPS


class Planning(Side):
    """One call of the planner."""

    def __init__(self) -> None:
        torch.set_num_threads(1)
        warnings.simplefilter("ignore")
        self._step = rows.RowsModel()
        world = WorldModelWrapper(
            TensorDictModule(_Scaled(self._step), ["state", "action"], ["state"]),
            TensorDictModule(_Reward(), ["state"], ["reward"]),
        )
        self._planner = MPPIPlanner(
            _World(world),
            _Return(),
            temperature=1.0,
            planning_horizon=problem.HORIZON,
            optim_steps=1,
            num_candidates=problem.CANDIDATES,
            top_k=problem.CANDIDATES,
        )
        blank = torch.zeros(1, dtype=torch.bool)
        self._given = TensorDict(
            {"state": rows.initial(), "done": blank, "terminated": blank}, batch_size=[]
        )

    @torch.inference_mode()
    @override
    def work(self) -> None:
        self._planner(self._given.clone())

    def answer(self) -> Sequence[float]:
        """Return positions `[3, H, 32]` of the dynamics that it is given, m."""
        return rows.positions(self._step)


class _Scaled(nn.Module):
    """Turns the planner's standard normal actions into commands about hover."""

    def __init__(self, step: rows.RowsModel) -> None:
        super().__init__()
        self.step = step
        hover = float(problem.inputs(1).trim.hover_thrust(GRAVITY_MPS2))
        sampler = SamplerSettings()
        sigma = [sampler.thrust_sigma * hover, *sampler.rate_sigma_radps]
        limit = torch.tensor([2 * hover, *RATE_LIMIT_RADPS])
        self.register_buffer("centre", torch.tensor([hover, 0.0, 0.0, 0.0]))
        self.register_buffer("sigma", torch.tensor(sigma))
        self.register_buffer("high", limit)
        self.register_buffer("low", torch.cat((torch.zeros(1), -limit[1:])))

    def forward(self, state: Tensor, action: Tensor) -> Tensor:
        return self.step(state, torch.clamp(self.centre + self.sigma * action, self.low, self.high))


class _Reward(nn.Module):
    def __init__(self) -> None:
        super().__init__()
        self.weights = CostWeights()
        self.register_buffer("goal", torch.tensor(problem.GOAL_M))

    def forward(self, state: Tensor) -> Tensor:
        away = torch.linalg.vector_norm(state[..., rows.POSITION] - self.goal, dim=-1)
        speed = torch.linalg.vector_norm(state[..., rows.VELOCITY], dim=-1)
        fast = (speed - self.weights.v_max_mps).clamp_min(0).square()
        return -(away + self.weights.speed * fast)[..., None]


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
