"""The planning problem in a file, for a peer whose Python is one that torch has no build for.

python -m benchmarks.peers.problem FILE.npz
"""

import sys

import numpy as np
import torch

from benchmarks import planning
from benchmarks.peers import batched


def main() -> None:
    """Write weights, constants, state, actions, and the positions of some candidates."""
    model = batched.BatchModel()
    arrays = {name: weight.numpy() for name, weight in model.state_dict().items()}
    actions = dict(zip(("centre", "sigma", "low", "high"), batched.actions(), strict=True))
    arrays |= {name: action.numpy() for name, action in actions.items()}
    candidates = planning.commands()[:, :, 0, : planning.CHECKED].permute(0, 2, 1)
    shape = (3, planning.HORIZON, planning.CHECKED)
    np.savez(
        sys.argv[1],
        initial=batched.initial().numpy(),
        candidates=candidates.numpy(),
        positions=np.reshape(planning.positions(), shape),
        sizes=(planning.CANDIDATES, planning.HORIZON),
        motion=(model.gain, model.weight_n, batched.KEEP, batched.MEAN, batched.CONTROL_DT_S),
        bounds=(batched.anchored.LINEAR_BOUND_MPS2, batched.anchored.ANGULAR_BOUND_RADPS2),
        goal=planning.GOAL_M,
        speed=(batched.WEIGHTS.speed, batched.WEIGHTS.v_max_mps),
        **arrays,
    )


if __name__ == "__main__":
    with torch.inference_mode():
        main()
