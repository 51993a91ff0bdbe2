"""Noise of a sampling planner, compiled."""

import ctypes

import torch
from torch import Tensor

from faultpath.quadrotor.native.lending import lend
from faultpath.quadrotor.native.library import Kernels


def noise(
    kernels: Kernels,
    keys: Tensor,
    step: int,
    size: tuple[int, int],
    correlation: tuple[float, float],
) -> Tensor:
    """Return normals `[H, 4, S, K]`, correlated along the horizon; candidate 0 has none.

    Args:
        kernels: Compiled kernels.
        keys: Of the Philox stream of each scene, `[S, 2]`, uint64.
        step: Which part of the streams.
        size: Steps of the horizon H and candidates K; whole vectors.
        correlation: What a step keeps of the one before, and how much of it is drawn afresh.
    """
    horizon, candidates = size
    scratch = torch.empty(4 * horizon * candidates, dtype=torch.int32)
    drawn = torch.empty(horizon, 4, len(keys), candidates)
    kernels.call(
        "faultpath_noise",
        lend("keys", keys, len(keys), 2, dtype=torch.uint64),
        *(step, horizon, len(keys), candidates),
        (ctypes.c_float * 2)(*correlation),
        lend("scratch", scratch, len(scratch), dtype=torch.int32),
        lend("noise", drawn, *drawn.shape),
    )
    return drawn
