"""Noise and candidates of a sampling planner, compiled."""

import ctypes
from collections.abc import Sequence

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


def candidates(
    kernels: Kernels,
    plan: Tensor,
    hover: Tensor,
    sigma: Sequence[float],
    limit: Sequence[float],
    noise: Tensor,
) -> Tensor:
    """Turn `noise` `[H, 4, S, K]` into commands, in place, and return it.

    Args:
        kernels: Compiled kernels.
        plan: `[H, 4, S]`.
        hover: Thrust that holds each vehicle, `[S]`, N; thrusts stay between 0 and twice that.
        sigma: Spread of the thrust as a fraction of `hover`, then of the three rates.
        limit: Of the rates, rad/s.
        noise: `[H, 4, S, K]`; K in whole vectors.
    """
    horizon, _, scenes, count = noise.shape
    kernels.call(
        "faultpath_candidates",
        lend("plan", plan.contiguous(), horizon, 4, scenes),
        lend("hover", hover.contiguous(), scenes),
        *((ctypes.c_float * 4)(*sigma), (ctypes.c_float * 3)(*limit)),
        *(horizon, scenes, count),
        lend("noise", noise, horizon, 4, scenes, count),
    )
    return noise
