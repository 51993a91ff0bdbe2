"""pytorch_mppi (UM-ARM-Lab): its `MPPI.command`, with a cheap goal and speed cost.

Two layouts. `rows` is the library's own: a dynamics function over `[K, nx]`, written with torch.nn.
`columns` hands it views of our own components-first predictor, which no user of the library would
write, to show how much of the difference is the layout. `compiled` calls the library's own
`compile`, which is torch.compile.
"""

from collections.abc import Callable

import torch
from pytorch_mppi import MPPI
from torch import Tensor

from benchmarks import problem
from benchmarks.measure import Side
from benchmarks.peers import rows
from benchmarks.planning import rollout
from faultpath.quadrotor.state import State


def command(scenes: int = 1, layout: str = "rows", compiled: bool = False) -> Side:
    """`MPPI.command` for some scenes, one after the other; the unit is one scene's."""
    model = rows.RowsModel()
    centre, sigma, low, high = rows.actions()
    planners = [
        MPPI(
            model if layout == "rows" else columns(),
            lambda state, action: rows.cost(state),
            nx=rows.STATE,
            noise_sigma=torch.diag(sigma.square()),
            num_samples=problem.CANDIDATES,
            horizon=problem.HORIZON,
            u_min=low,
            u_max=high,
            u_init=centre,
            U_init=centre.repeat(problem.HORIZON, 1),
        )
        for _ in range(scenes)
    ]
    if compiled:
        for planner in planners:
            planner.compile()
    state = rows.initial()

    def work() -> None:
        for planner in planners:
            planner.command(state)

    own = layout == "rows"
    return Side(work, scenes, (lambda: rows.positions(model)) if own else rollout().answer)


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
