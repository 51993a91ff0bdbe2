"""The choices a user makes about the quadrotor system, and the frozen settings behind them."""

from collections.abc import Sequence
from enum import StrEnum
from typing import Self

import torch
from pydantic import BaseModel, ConfigDict, Field

from faultpath.errors import UserError
from faultpath.quadrotor.device import DeviceName, require
from faultpath.quadrotor.models import PREDICTORS
from faultpath.quadrotor.planner import (
    MPPI,
    AutoregressiveSampler,
    BundledSampler,
    CostWeights,
    GoalCost,
    NavigationCost,
    RunningGoal,
    Sampler,
    SamplerSettings,
    ScaledTemperature,
    Temperature,
    TerminalGoal,
    WithinBundle,
)
from faultpath.quadrotor.predictors import Predictor
from faultpath.quadrotor.rollout import rolling


class Wind(StrEnum):
    """Wind levels (paper, Section IV-B)."""

    L0 = "L0"
    L1 = "L1"
    L2 = "L2"
    L3 = "L3"


class Environment(StrEnum):
    """Whether the scene's obstacles are there or only its outer boundaries."""

    OBSTACLES = "obstacles"
    FREE_SPACE = "free-space"


class ClearanceName(StrEnum):
    """Source of the clearance channel."""

    DEPTH = "depth"
    TRUE = "true"


class PlannerName(StrEnum):
    """Planner variants: where along the horizon the distance to the goal counts."""

    TERMINAL = "terminal"
    RUNNING = "running"


class SamplerName(StrEnum):
    """Samplers of candidates; see `AutoregressiveSampler` and `planner.modes`."""

    AUTOREGRESSIVE = "autoregressive"
    MODE_PRESERVING = "mode-preserving"


class PlannerSettings(BaseModel):
    """Everything of the planner that the platform search chose; frozen since."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    sampler: SamplerSettings = SamplerSettings()
    terminal: CostWeights = CostWeights()
    running: CostWeights = CostWeights(thrust_effort=5.0)
    """A mean distance gains less from a change of thrust than the distance at the end does, so
    the same effort weight would weigh more."""
    temperature: float = 0.08
    """Fraction of the spread of the better half of the candidates' costs."""


class QuadrotorOptions(BaseModel):
    """One configuration of the quadrotor."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    wind: Wind = Wind.L0
    environment: Environment = Environment.OBSTACLES
    clearance: ClearanceName = ClearanceName.DEPTH
    predictor: str = "wm-a-wind"
    """Predictor of the variants that name none, a key of `models.PREDICTORS`."""
    predictor_seed: int = Field(default=0, ge=0, le=2)
    """Which training of it; variants that name a predictor take the seed of their arm."""
    planner: PlannerName = PlannerName.TERMINAL
    sampler: SamplerName = SamplerName.AUTOREGRESSIVE
    candidates: int = SamplerSettings().candidates
    settings: PlannerSettings = PlannerSettings()
    device: DeviceName = DeviceName.CPU
    """What computes worlds and planners; see `docs/design/device.md`."""

    @classmethod
    def parse(cls, **options: str) -> Self:
        """Read options as the command line gives them; `UserError` names what there is.

        Trials in free space have ground-truth clearance, those among obstacles the depth model,
        unless `clearance` says otherwise (paper, Section IV-A).
        """
        kinds: dict[str, Sequence[str]] = {
            "wind": tuple(Wind),
            "environment": tuple(Environment),
            "clearance": tuple(ClearanceName),
            "predictor": tuple(PREDICTORS),
            "predictor_seed": ("0", "1", "2"),
            "planner": tuple(PlannerName),
            "sampler": tuple(SamplerName),
            "candidates": ("512", "1024", "2048"),  # paper, Sections IV-A and VII-B
            "device": tuple(DeviceName),
        }
        unknown = sorted(set(options) - set(kinds))
        if unknown:
            raise UserError(
                f"the quadrotor has no option '{unknown[0]}'; it has {', '.join(kinds)}."
            )
        for option, value in options.items():
            if value not in kinds[option]:
                known = ", ".join(kinds[option])
                raise UserError(f"unknown {option} '{value}'; choose one of {known}.")
        if options.get("environment") == Environment.FREE_SPACE:
            options.setdefault("clearance", ClearanceName.TRUE)
        parsed = cls.model_validate(options)
        require(parsed.device)
        return parsed

    @property
    def free_space(self) -> bool:
        """Whether only the outer boundaries are there."""
        return self.environment is Environment.FREE_SPACE

    @property
    def place(self) -> torch.device:
        """Where tensors are made."""
        return self.device.place

    def build_planner(self, predictor: Predictor) -> MPPI:
        """Return the planner that the options name, around a predictor."""
        goals: dict[PlannerName, tuple[GoalCost, CostWeights]] = {
            PlannerName.TERMINAL: (TerminalGoal(), self.settings.terminal),
            PlannerName.RUNNING: (RunningGoal(), self.settings.running),
        }
        goal, weights = goals[self.planner]
        settings = self.settings.sampler.model_copy(update={"candidates": self.candidates})
        sampler: Sampler = AutoregressiveSampler(settings)
        temperature: Temperature = ScaledTemperature(self.settings.temperature)
        if self.sampler is SamplerName.MODE_PRESERVING:
            sampler, temperature = BundledSampler(sampler), WithinBundle(temperature)
        cost, roll = NavigationCost(goal, weights), rolling(predictor, self.place)
        return MPPI(predictor, sampler, cost, temperature, roll)
