"""Noise and candidates of the planner, compiled."""

import math
from collections.abc import Sequence
from typing import TypeGuard

import numpy as np
import torch
from torch import Tensor

from faultpath.quadrotor.device import at_hand
from faultpath.quadrotor.native.lending import is_exactly, lend
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
        if not is_exactly(sampler, AutoregressiveSampler):
            return False
        return sampler.settings.candidates % WIDEST == 0

    def noise(self, scenes: Sequence[str], seed: int, step: int) -> Tensor:
        """See `Sampler.noise`."""
        horizon, candidates = self.settings.horizon, self.settings.candidates
        drawn = [words(key("planner", scene, seed)) for scene in scenes]
        keys = np.array(drawn, dtype=np.uint64).reshape(-1, 2)
        noise = torch.empty(horizon, 4, len(scenes), candidates)
        self._kernels.call(
            "faultpath_noise",
            lend("keys", torch.from_numpy(keys), len(scenes), 2, dtype=torch.uint64),
            *(step, horizon, len(scenes), candidates),
            lend("correlation", self._correlation, 2),
            lend("scratch", self._scratch, 4 * horizon * candidates, dtype=torch.int32),
            lend("noise", noise, horizon, 4, len(scenes), candidates),
        )
        return noise

    def candidates(self, plan: Tensor, hover: Tensor, noise: Tensor) -> Tensor:
        """See `Sampler.candidates`; `ValueError` for a tensor of another form, see `lend`."""
        horizon, _, scenes, candidates = noise.shape
        if not at_hand(noise.device) or candidates % WIDEST:
            return super().candidates(plan, hover, noise)
        self._kernels.call(
            "faultpath_candidates",
            lend("plan", plan.contiguous(), horizon, 4, scenes),
            lend("hover", hover.contiguous(), scenes),
            *(lend("sigma", self._sigma, 4), lend("limit", self._limit, 3)),
            *(horizon, scenes, candidates),
            lend("noise", noise, horizon, 4, scenes, candidates),
        )
        return noise
