"""pytorch_mppi (UM-ARM-Lab): its `MPPI.command`, with a cheap goal and speed cost.

Two layouts. `rows` is the library's own: a dynamics function over `[K, nx]`, written with torch.nn.
`columns` hands it views of our own components-first predictor, which no user of the library would
write, to show how much of the difference is the layout. `compiled` calls the library's own
`compile`, which is torch.compile.
"""

from collections.abc import Callable, Sequence

import torch
from pytorch_mppi import MPPI
from torch import Tensor
from typing_extensions import override

from benchmarks import problem
from benchmarks.peers import rows
from benchmarks.planner import Rollout
from benchmarks.side import Side
from faultpath.quadrotor.planner import CostWeights, SamplerSettings
from faultpath.quadrotor.state import State
from faultpath.quadrotor.vehicle import GRAVITY_MPS2, RATE_LIMIT_RADPS


class Command(Side):
    """`MPPI.command` for some scenes, one after the other; the unit is one scene's."""

    def __init__(self, scenes: int = 1, layout: str = "rows", compiled: bool = False) -> None:
        torch.set_num_threads(1)
        self.amount = scenes
        self._layout = layout
        self._step = rows.RowsModel() if layout == "rows" else None
        self._state = rows.initial()
        dynamics = self._step or columns()
        hover = problem.inputs(1).trim.hover_thrust(GRAVITY_MPS2)[0, 0]
        sampler, cost = SamplerSettings(), CostWeights()
        sigma = torch.tensor([sampler.thrust_sigma * float(hover), *sampler.rate_sigma_radps])
        limit = torch.tensor([2 * float(hover), *RATE_LIMIT_RADPS])
        goal = torch.tensor(problem.GOAL_M)
        plan = torch.zeros(problem.HORIZON, 4)
        plan[:, 0] = hover

        def running_cost(state: Tensor, action: Tensor) -> Tensor:
            away = torch.linalg.vector_norm(state[:, rows.POSITION] - goal, dim=1)
            speed = torch.linalg.vector_norm(state[:, rows.VELOCITY], dim=1)
            return away + cost.speed * (speed - cost.v_max_mps).clamp_min(0).square()

        low = torch.cat((torch.zeros(1), -limit[1:]))
        self._planners = [
            MPPI(
                dynamics,
                running_cost,
                nx=rows.STATE,
                noise_sigma=torch.diag(sigma.square()),
                num_samples=problem.CANDIDATES,
                horizon=problem.HORIZON,
                u_min=low,
                u_max=limit,
                u_init=plan[0],
                U_init=plan.clone(),
            )
            for _ in range(scenes)
        ]
        if compiled:
            for planner in self._planners:
                planner.compile()

    @torch.inference_mode()
    @override
    def work(self) -> None:
        for planner in self._planners:
            planner.command(self._state)

    def answer(self) -> Sequence[float]:
        """Return positions `[3, H, 32]` of the dynamics that it is given, m."""
        return Rollout().answer() if self._step is None else rows.positions(self._step)


def columns() -> Callable[[Tensor, Tensor], Tensor]:
    """Return our predictor's step behind views: `[K, 50]` outside, components first inside."""
    predictor, given = problem.model(), problem.inputs(1)
    memory = predictor.begin(given)

    def step(state: Tensor, command: Tensor) -> Tensor:
        parts = state.T[:, None]
        now = State(
            parts[rows.POSITION],
            parts[rows.VELOCITY],
            parts[rows.ROTATION].unflatten(0, (3, 3)),
            parts[rows.RATE],
        )
        held = type(memory)(memory.network, parts[rows.CODE], memory.constants, memory.mass_kg)
        ahead, after = predictor.step(now, command.T.contiguous()[:, None], held)
        flat = (ahead.position, ahead.velocity, ahead.rotation.flatten(0, 1), ahead.rate)
        return torch.cat((*flat, after.latent))[:, 0].T

    return step
