"""Candidate commands around a plan."""

import ctypes
import math
from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor
from typing_extensions import override

from faultpath.plugin.system import Frozen, generator, key, words
from faultpath_quadrotor import native
from faultpath_quadrotor.native.kernel_args import lend, output
from faultpath_quadrotor.vehicle import RATE_LIMIT_RADPS


class SamplerSettings(Frozen):
    """Spread of the candidates. Sources: DATT, PA-MPPI and Minarik et al. for rho and sigma."""

    candidates: int = 512  # paper, Section IV-A
    horizon: int = 20  # paper, Section IV-A
    correlation: float = 0.7
    thrust_sigma: float = 0.22
    """Standard deviation of the thrust noise as a fraction of the hover thrust."""
    rate_sigma_radps: tuple[float, float, float] = (1.0, 1.0, 0.4)


def scales(settings: SamplerSettings, hover: Tensor) -> Tensor:
    """Return the standard deviations `[4, S, 1]` of commands about a plan, N and rad/s."""
    scale = hover.new_empty(4, hover.shape[0], 1)
    scale[0, :, 0] = settings.thrust_sigma * hover
    for axis, sigma in enumerate(settings.rate_sigma_radps):
        scale[axis + 1].fill_(sigma)
    return scale


def bound(commands: Tensor, hover: Tensor) -> Tensor:
    """Return commands `[H, 4, S, K]` within the vehicle's limits, in place; see `candidates`."""
    thrust = commands[:, 0]
    torch.minimum(thrust.clamp_(min=0), 2 * hover[:, None], out=thrust)
    for axis, limit in enumerate(RATE_LIMIT_RADPS):
        commands[:, axis + 1].clamp_(-limit, limit)
    return commands


class AutoregressiveSampler:
    """First-order autoregressive noise over the horizon; candidate 0 is the plan itself."""

    def __init__(self, settings: SamplerSettings | None = None) -> None:
        self.settings = settings or SamplerSettings()

    def noise(self, scenes: Sequence[str], seed: int, step: int, iteration: int = 0) -> Tensor:
        """Return standardised noise `[H, 4, S, K]`, keyed by scene, seed, step and iteration.

        The host draws, whatever device plans.
        """
        horizon, candidates = self.settings.horizon, self.settings.candidates
        purpose = f"planner/{iteration}" if iteration else "planner"
        rho = self.settings.correlation
        fresh = math.sqrt(1 - rho**2)
        shape = horizon, 4, len(scenes), candidates
        built = native.kernels()
        if built is not None and native.whole_vectors(candidates):
            drawn = [words(key(purpose, scene, seed)) for scene in scenes]
            keys = torch.from_numpy(np.array(drawn, dtype=np.uint64).reshape(-1, 2))
            scratch, filled = output(4 * horizon * candidates, dtype=torch.int32), output(*shape)
            built.call(
                "faultpath_noise",
                lend("keys", keys, len(scenes), 2, dtype=torch.uint64),
                *(step, horizon, len(scenes), candidates),
                *((ctypes.c_float * 2)(rho, fresh), scratch, filled),
            )
            return filled.tensor
        noise = torch.empty(shape)
        for i, scene in enumerate(scenes):
            draws = generator(purpose, scene, seed, step)
            normals = standard_normals(draws, horizon * 4 * candidates)
            noise[:, :, i] = normals.view(horizon, 4, candidates)
        noise[1:] *= fresh
        for h in range(1, horizon):
            noise[h].add_(noise[h - 1], alpha=rho)
        noise[..., 0] = 0
        return noise

    def candidates(self, plan: Tensor, hover: Tensor, noise: Tensor) -> Tensor:
        """Return commands `[H, 4, S, K]` around `plan` `[H, 4, S]`; `noise` is overwritten.

        `hover` `[S]` is the thrust that the predictor believes holds the vehicle. The thrust
        bounds lie evenly around it: bounds that cut one side lift the mean plan and would hide
        one sign of a calibration fault.
        """
        return bound(noise.mul_(scales(self.settings, hover)).add_(plan[..., None]), hover)


BUNDLES = 8
"""Divides every number of candidates that the options offer."""
SHARED = 0.5
"""Share of a candidate's variance that is its bundle's centre (derived: as much between bundles as
within them)."""


class BundledSampler(AutoregressiveSampler):
    """Candidates in bundles of neighbours, for a planner that keeps its modes apart.

    The first candidate of a bundle is its centre. Each other one is drawn anew about it, so a
    candidate alone is distributed as before. The first bundle's centre is the plan itself.
    """

    @override
    def noise(self, scenes: Sequence[str], seed: int, step: int, iteration: int = 0) -> Tensor:
        noise = super().noise(scenes, seed, step, iteration)
        bundled = noise.unflatten(-1, (BUNDLES, -1))
        bundled[..., 1:].mul_(math.sqrt(1 - SHARED)).add_(bundled[..., :1], alpha=math.sqrt(SHARED))
        return noise


def standard_normals(draws: np.random.Generator, count: int) -> Tensor:
    """Return `count` (even) standard normals, float32, from the bits of a counter-based stream.

    Box and Muller (1958): two uniforms make two normals. The transcendental functions run
    vectorised, which takes a third of the time of the generator's own rejection method.
    """
    half = count // 2
    bits = draws.bit_generator.random_raw(half).view(np.int32)
    uniform = torch.from_numpy(bits).to(torch.float32).mul_(2.0**-32)  # from -1/2 to 1/2
    # Above zero by half a step of the integers, so that the logarithm is finite.
    radius = uniform[:half].add_(0.5).add_(2.0**-33).log_().mul_(-2).clamp_(min=0).sqrt_()
    angle = uniform[half:].mul_(2 * math.pi)
    normals = torch.empty(count)
    torch.mul(angle.cos(), radius, out=normals[:half])
    torch.mul(angle.sin(), radius, out=normals[half:])
    return normals
