"""pytorch_mppi (UM-ARM-Lab): its `MPPI.command`, with a cheap goal and speed cost.

The model is a dynamics function over `[K, nx]`, written with torch.nn, as the library asks for it.
"""

import torch
from pytorch_mppi import MPPI

from benchmarks import planning
from benchmarks.peers import batched
from benchmarks.side import Side, check_same


def command() -> Side:
    model = batched.BatchModel()
    check_same(batched.positions(model), planning.positions(), 1e-3)
    centre, sigma, low, high = batched.actions()
    planner = MPPI(
        model,
        lambda state, action: batched.cost(state),
        nx=batched.STATE,
        noise_sigma=torch.diag(sigma.square()),
        num_samples=planning.CANDIDATES,
        horizon=planning.HORIZON,
        u_min=low,
        u_max=high,
        u_init=centre,
        U_init=centre.repeat(planning.HORIZON, 1),
    )
    state = batched.initial()
    return Side(lambda: planner.command(state))
