"""Noise and costs of candidates, compiled."""

import ctypes
from collections.abc import Mapping
from typing import NamedTuple

import torch
from torch import Tensor

from faultpath_quadrotor.native.kernel_args import as_kernel_argument
from faultpath_quadrotor.native.library import Kernels

TERMS = (
    *("running", "goal", "risk", "hit", "margin_m", "radius_m", "speed", "v_max_mps", "heading"),
    *("rate_effort", "thrust_effort"),
)
"""Weights of a cost, and the distances and speeds that they refer to. `running` is the share of the
mean distance along the horizon; the rest is the distance at its end."""


class _Weights(ctypes.Structure):
    """`Weights` of `costs.cpp`."""

    _fields_ = tuple((name, ctypes.c_float) for name in TERMS)


class Paths(NamedTuple):
    """Candidates to score: K of S scenes over H steps."""

    positions: Tensor
    """`[3, S, H, K]`, m."""
    velocities: Tensor
    """`[3, S, H, K]`, m/s."""
    rotation: Tensor
    """At the end, `[3, 3, S, K]`."""
    commands: Tensor
    """`[H, 4, S, K]`."""
    clearance: Tensor
    """`[S, H, K]`, m."""
    goal: Tensor
    """`[3, S]`, m."""
    hover: Tensor
    """`[S]`, N."""


def cost(kernels: Kernels, terms: Mapping[str, float], paths: Paths) -> Tensor:
    """Return the cost `[S, K]` of candidates.

    Args:
        kernels: Compiled kernels.
        terms: A number for each of `TERMS`.
        paths: The candidates; at least one step, and K in whole vectors.

    Raises:
        ValueError: A term is missing, or a tensor is not what the kernel takes; see
            `as_kernel_argument`.
    """
    if set(terms) != set(TERMS):
        raise ValueError(f"compiled cost: it takes {', '.join(TERMS)}")
    steps, _, scenes, count = paths.commands.shape
    costs = paths.commands.new_empty(scenes, count)
    moved = (3, scenes, steps, count)
    kernels.call(
        "faultpath_cost",
        ctypes.byref(_Weights(**terms)),
        as_kernel_argument("positions", paths.positions.contiguous(), *moved),
        as_kernel_argument("velocities", paths.velocities.contiguous(), *moved),
        as_kernel_argument("rotation", paths.rotation.contiguous(), 3, 3, scenes, count),
        as_kernel_argument("commands", paths.commands.contiguous(), steps, 4, scenes, count),
        as_kernel_argument("clearance", paths.clearance.contiguous(), scenes, steps, count),
        as_kernel_argument("goal", paths.goal.contiguous(), 3, scenes),
        as_kernel_argument("hover", paths.hover.contiguous(), scenes),
        *(steps, scenes, count),
        as_kernel_argument("costs", costs, scenes, count),
    )
    return costs


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
        keys: Keys of the scenes' Philox streams, `[S, 2]`, uint64.
        step: Which part of the streams.
        size: Steps of the horizon H and candidates K; whole vectors.
        correlation: What a step keeps of the one before, and how much of it is drawn afresh.
    """
    horizon, candidates = size
    scratch = torch.empty(4 * horizon * candidates, dtype=torch.int32)
    drawn = torch.empty(horizon, 4, len(keys), candidates)
    kernels.call(
        "faultpath_noise",
        as_kernel_argument("keys", keys, len(keys), 2, dtype=torch.uint64),
        *(step, horizon, len(keys), candidates),
        (ctypes.c_float * 2)(*correlation),
        as_kernel_argument("scratch", scratch, len(scratch), dtype=torch.int32),
        as_kernel_argument("noise", drawn, *drawn.shape),
    )
    return drawn


def weights(kernels: Kernels, costs: Tensor, fraction: float, least: float) -> Tensor:
    """Return the weights `[S, K]` of candidates with costs `[S, K]`; see `mppi.softmax`.

    Args:
        kernels: Compiled kernels.
        costs: K in whole vectors.
        fraction: Temperature over the spread of the better half.
        least: Lowest temperature.
    """
    scenes, candidates = costs.shape
    ranks, weighed = torch.empty(candidates, dtype=torch.int32), torch.empty_like(costs)
    kernels.call(
        "faultpath_weigh",
        as_kernel_argument("costs", costs.contiguous(), scenes, candidates),
        (ctypes.c_float * 2)(fraction, least),
        *(scenes, candidates),
        as_kernel_argument("ranks", ranks, candidates, dtype=torch.int32),
        as_kernel_argument("weights", weighed, scenes, candidates),
    )
    return weighed


def mean(kernels: Kernels, commands: Tensor, weights: Tensor) -> Tensor:
    """Return the mean `[H, 4, S]` of commands `[H, 4, S, K]` under weights `[S, K]`."""
    steps, axes, scenes, candidates = commands.shape
    means = commands.new_empty(steps, axes, scenes)
    kernels.call(
        "faultpath_mean",
        as_kernel_argument("commands", commands.contiguous(), steps, axes, scenes, candidates),
        as_kernel_argument("weights", weights.contiguous(), scenes, candidates),
        *(steps * axes, scenes, candidates),
        as_kernel_argument("means", means, steps, axes, scenes),
    )
    return means
