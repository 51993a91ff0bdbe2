"""What a user chose of the quadrotor, and the frozen settings behind it."""

from pathlib import Path
from typing import Self

import torch

from faultpath.errors import UserError
from faultpath.quadrotor.choices import (
    ClearanceName,
    DeviceName,
    Environment,
    PlannerName,
    PlantName,
    QuadrotorChoices,
    SamplerName,
)
from faultpath.quadrotor.device import device_of, require
from faultpath.quadrotor.planners import (
    CEM,
    MPPI,
    AutoregressiveSampler,
    BundledSampler,
    CEMSettings,
    CostWeights,
    GoalCost,
    NavigationCost,
    Planner,
    RunningGoal,
    Sampler,
    SamplerSettings,
    ScaledTemperature,
    Temperature,
    TerminalGoal,
    WithinBundle,
    goal_cost,
)
from faultpath.quadrotor.plant import Plant, TorchPlant
from faultpath.quadrotor.platform import Platform
from faultpath.quadrotor.platforms import DEFAULT, PLATFORMS
from faultpath.trials.options import call


class QuadrotorOptions(QuadrotorChoices):
    """One configuration of the quadrotor: what a user chose, and what is behind it."""

    settings: Platform = DEFAULT
    """The platform of that name; a search puts its own here."""
    checkpoints: Path | None = None
    """Folder of the trained models; `None`: the package's of the platform of that name."""

    @classmethod
    def of(cls, choices: QuadrotorChoices) -> Self:
        """Return the options behind some choices.

        Trials in free space have ground-truth clearance, those among obstacles the depth model,
        unless `clearance` says otherwise (paper, Section IV-A).

        Raises:
            UserError: There is no such device, or the plant does not fly on it.
            ModuleNotFoundError: The plant needs a package that is not installed.
        """
        given = choices.model_dump(include=choices.model_fields_set)
        given["settings"] = PLATFORMS[choices.platform]
        _check_planner(choices)
        if choices.bring and not all(part.strip() for part in choices.bring.split(",")):
            raise UserError(
                f"bring '{choices.bring}' holds an empty name: part names by one comma each."
            )
        if choices.environment is Environment.FREE_SPACE:
            given.setdefault("clearance", ClearanceName.TRUE)
        if choices.plant is not PlantName.TORCH and choices.device is not DeviceName.CPU:
            raise UserError(
                f"plant '{choices.plant}' flies on the CPU only: leave --device out, or --plant."
            )
        require(choices.device)
        options = cls.model_validate(given)
        _ = options.plant_class  # what is missing is missed before anything flies
        return options

    @classmethod
    def parse(cls, **options: str) -> Self:
        """Read options as the command line gives them; `UserError` names what there is."""
        return call(cls.of, options, "the quadrotor")

    @property
    def free_space(self) -> bool:
        """Whether only the outer boundaries are there."""
        return self.environment is Environment.FREE_SPACE

    @property
    def place(self) -> torch.device:
        """Where tensors are made."""
        return device_of(self.device)

    @property
    def plant_class(self) -> type[Plant]:
        """What flies the vehicles; `ModuleNotFoundError` where its package is not installed."""
        if self.plant is PlantName.MUJOCO:
            from faultpath.quadrotor.plant.mujoco_plant import MujocoPlant

            return MujocoPlant
        return TorchPlant

    @property
    def sampling(self) -> SamplerSettings:
        """How many candidates are drawn, and how."""
        return self.settings.planner.sampler.model_copy(update={"candidates": self.candidates})

    def build_planner(self) -> Planner:
        """Return the planner that the options name."""
        planner = self.settings.planner
        goals: dict[PlannerName, tuple[GoalCost, CostWeights]] = {
            PlannerName.TERMINAL: (TerminalGoal(), planner.weights),
            PlannerName.RUNNING: (RunningGoal(), planner.running),
        }
        own = (goal_cost(planner.goal_running), planner.weights)
        goal, weights = goals.get(self.planner, own)
        sampler: Sampler = AutoregressiveSampler(self.sampling)
        cost = NavigationCost(goal, weights)
        if self.planner is PlannerName.CEM:
            narrowing = CEMSettings(iterations=self.iterations, elites=self.elites)
            return CEM(sampler, cost, narrowing)
        temperature: Temperature = ScaledTemperature(planner.temperature)
        if self.sampler is SamplerName.MODE_PRESERVING:
            sampler, temperature = BundledSampler(sampler), WithinBundle(temperature)
        return MPPI(sampler, cost, temperature)


def _check_planner(choices: QuadrotorChoices) -> None:
    """Raise `UserError` for what does not apply to the planner that is chosen."""
    if choices.planner is not PlannerName.CEM:
        idle = sorted({"elites", "iterations"} & choices.model_fields_set)
        if idle:
            raise UserError(
                f"{idle[0]} belongs to planner cem, and planner {choices.planner} has none: add "
                f"--planner cem or leave {idle[0]} out."
            )
    elif choices.sampler is SamplerName.MODE_PRESERVING:
        raise UserError(
            "the mode-preserving sampler keeps the modes of MPPI apart, and planner cem has its "
            "own way to narrow: leave the sampler or the planner out."
        )
