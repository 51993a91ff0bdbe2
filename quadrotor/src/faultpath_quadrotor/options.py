"""A user's choices for the quadrotor, and the frozen settings behind them."""

from collections.abc import Mapping
from typing import Self

import torch

from faultpath.plugin.system import UserError, call
from faultpath_quadrotor.choices import (
    ESTIMATORS,
    ClearanceName,
    DeviceName,
    Environment,
    QuadrotorChoices,
    SamplerName,
)
from faultpath_quadrotor.device import device_of, require
from faultpath_quadrotor.planners import (
    CEM,
    MPPI,
    AutoregressiveSampler,
    BundledSampler,
    NavigationCost,
    Planner,
    SamplerSettings,
)
from faultpath_quadrotor.platform import PLATFORM

PLANNERS: Mapping[str, type[Planner]] = {"mppi": MPPI, "cem": CEM}
"""Classes of `choices.PLANNERS`; `build_planner` builds them."""


class QuadrotorOptions(QuadrotorChoices):
    """One configuration of the quadrotor: a user's choices, and the defaults that follow."""

    @classmethod
    def of(cls, choices: QuadrotorChoices) -> Self:
        """Return the options behind some choices. A shipped filter reads sensors that err.

        Trials in free space have ground-truth clearance, those among obstacles the depth model,
        unless `clearance` says otherwise (paper, Section IV-A).

        Raises:
            UserError: There is no such device, or the plant does not fly on it.
        """
        options = choices.model_dump(include=choices.model_fields_set)
        if choices.bring and not all(part.strip() for part in choices.bring.split(",")):
            raise UserError(
                f"bring '{choices.bring}' holds an empty name: part names by one comma each."
            )
        if choices.environment is Environment.FREE_SPACE:
            options.setdefault("clearance", ClearanceName.TRUE)
        if choices.estimator in ESTIMATORS:
            options.setdefault("sensor_noise", 1.0)
        if choices.plant != "torch" and choices.device is not DeviceName.CPU:
            raise UserError(
                f"plant '{choices.plant}' flies on the CPU only: leave --device out, or --plant."
            )
        kind = PLANNERS.get(choices.planner)
        if choices.sampler is SamplerName.MODE_PRESERVING and kind and not kind.keeps_modes:
            raise UserError(
                f"planner '{choices.planner}' fits one mean to all candidates, so no sampler keeps "
                "its modes apart: leave --sampler out, or plan with mppi."
            )
        require(choices.device)
        return cls.model_validate(options)

    @classmethod
    def parse(cls, **options: str) -> Self:
        """Read options as the command line gives them; `UserError` names the valid ones."""
        return call(cls.of, options, "the quadrotor")

    @property
    def filtered(self) -> bool:
        """Whether a shipped filter estimates the state; all shipped filters are variants then."""
        return self.estimator in ESTIMATORS

    @property
    def free_space(self) -> bool:
        """Whether only the outer boundaries are there."""
        return self.environment is Environment.FREE_SPACE

    @property
    def place(self) -> torch.device:
        """Device of the tensors."""
        return device_of(self.device)

    @property
    def sampling(self) -> SamplerSettings:
        """How many candidates are drawn at once, and how."""
        candidates = self.candidates // PLANNERS.get(self.planner, Planner).iterations
        return PLATFORM.planner.sampler.model_copy(update={"candidates": candidates})

    def build_planner(self) -> Planner:
        """Return the shipped planner of these options."""
        bundled = self.sampler is SamplerName.MODE_PRESERVING
        sampler = (BundledSampler if bundled else AutoregressiveSampler)(self.sampling)
        cost = NavigationCost(PLATFORM.planner.weights)
        if self.planner == "cem":
            return CEM(sampler, cost)
        return MPPI(sampler, cost, PLATFORM.planner.temperature)
