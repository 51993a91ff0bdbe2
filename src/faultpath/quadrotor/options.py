"""The choices a user makes about the quadrotor system, and the frozen settings behind them."""

from enum import StrEnum
from typing import Self, TypeVar

from pydantic import BaseModel, ConfigDict

from faultpath.errors import UserError
from faultpath.quadrotor.planner import (
    MPPI,
    AutoregressiveSampler,
    CostWeights,
    GoalCost,
    NavigationCost,
    RunningGoal,
    SamplerSettings,
    ScaledTemperature,
    TerminalGoal,
)
from faultpath.quadrotor.predictors import KinematicIntegrator, Predictor, TrueParameter


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


class PredictorName(StrEnum):
    """Analytic predictors."""

    DKI = "dki"
    DKI_DRAG = "dki-drag"
    TRUE_PARAMETER = "true-parameter"


class PlannerName(StrEnum):
    """Planner variants: where along the horizon the distance to the goal counts."""

    TERMINAL = "terminal"
    RUNNING = "running"


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


_Choice = TypeVar("_Choice", bound=StrEnum)


class QuadrotorOptions(BaseModel):
    """One configuration of the quadrotor."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    wind: Wind = Wind.L0
    environment: Environment = Environment.OBSTACLES
    predictor: PredictorName = PredictorName.DKI_DRAG
    planner: PlannerName = PlannerName.TERMINAL
    settings: PlannerSettings = PlannerSettings()

    @classmethod
    def parse(cls, **options: str) -> Self:
        """Read options as the command line gives them; `UserError` names what there is."""
        kinds = {
            "wind": Wind,
            "environment": Environment,
            "predictor": PredictorName,
            "planner": PlannerName,
        }
        unknown = sorted(set(options) - set(kinds))
        if unknown:
            raise UserError(
                f"the quadrotor has no option '{unknown[0]}'; it has {', '.join(kinds)}."
            )
        return cls.model_validate({k: _choose(k, kinds[k], v) for k, v in options.items()})

    def build_predictor(self) -> Predictor:
        """Return the predictor that the options name."""
        builders = {
            PredictorName.DKI: KinematicIntegrator,
            PredictorName.DKI_DRAG: lambda: KinematicIntegrator(drag=True),
            PredictorName.TRUE_PARAMETER: TrueParameter,
        }
        return builders[self.predictor]()

    def build_planner(self) -> MPPI:
        """Return the planner that the options name, around their predictor."""
        goals: dict[PlannerName, tuple[GoalCost, CostWeights]] = {
            PlannerName.TERMINAL: (TerminalGoal(), self.settings.terminal),
            PlannerName.RUNNING: (RunningGoal(), self.settings.running),
        }
        goal, weights = goals[self.planner]
        return MPPI(
            self.build_predictor(),
            AutoregressiveSampler(self.settings.sampler),
            NavigationCost(goal, weights),
            ScaledTemperature(self.settings.temperature),
        )


def _choose(option: str, kind: type[_Choice], value: str) -> _Choice:
    try:
        return kind(value)
    except ValueError:
        known = ", ".join(kind)
        raise UserError(f"unknown {option} '{value}'; choose one of {known}.") from None
