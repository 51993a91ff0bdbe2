"""Noise and candidates of the planner, compiled."""

import math
from collections.abc import Sequence
from typing import TypeGuard

import numpy as np
import torch
from torch import Tensor

from faultpath.quadrotor.device import at_hand
from faultpath.quadrotor.native.library import WIDEST, Kernels
from faultpath.quadrotor.planner.sampler import AutoregressiveSampler
from faultpath.quadrotor.vehicle import RATE_LIMIT_RADPS
from faultpath.streams import key, words


class CompiledSampler(AutoregressiveSampler):
    """The autoregressive sampler with its transcendental functions and passes compiled."""

    def __init__(self, kernels: Kernels, sampler: AutoregressiveSampler) -> None:
        super().__init__(sampler.settings)
        self._kernels = kernels
        rho = self.settings.correlation
        self._correlation = torch.tensor([rho, math.sqrt(1 - rho**2)])
        self._sigma = torch.tensor([self.settings.thrust_sigma, *self.settings.rate_sigma_radps])
        numbers = 4 * self.settings.horizon * self.settings.candidates
        self._scratch = torch.empty(numbers, dtype=torch.int32)
        self._limit = torch.tensor(RATE_LIMIT_RADPS, dtype=torch.float32)

    @staticmethod
    def covers(sampler: object) -> TypeGuard[AutoregressiveSampler]:
        """Return whether `sampler` is one that this can stand for."""
        return type(sampler) is AutoregressiveSampler and sampler.settings.candidates % WIDEST == 0

    def noise(self, scenes: Sequence[str], seed: int, step: int) -> Tensor:
        """See `Sampler.noise`."""
        horizon, candidates = self.settings.horizon, self.settings.candidates
        keys = np.array([words(key("planner", scene, seed)) for scene in scenes])
        noise = torch.empty(horizon, 4, len(scenes), candidates)
        self._kernels.call(
            "faultpath_noise",
            torch.from_numpy(keys),
            *(step, horizon, len(scenes), candidates),
            *(self._correlation, self._scratch, noise),
        )
        return noise

    def candidates(self, plan: Tensor, hover: Tensor, noise: Tensor) -> Tensor:
        """See `Sampler.candidates`."""
        if not at_hand(noise.device):
            return super().candidates(plan, hover, noise)
        horizon, _, scenes, candidates = noise.shape
        self._kernels.call(
            "faultpath_candidates",
            *(plan.contiguous(), hover.contiguous(), self._sigma, self._limit),
            *(horizon, scenes, candidates, noise),
        )
        return noise
