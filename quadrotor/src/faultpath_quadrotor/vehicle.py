"""The vehicle: nominal numbers with their sources, and the ranges that episodes draw from.

Sources, abbreviated: [P] the paper; [AF] uzh-rpg/agile_flight, `quads/kingfisher.yaml` and
`quads/blackbird.yaml`; [DA] flyingbitac/diffaero, `cfg/dynamics/quad.yaml`; [SJ] the ranges of
SkyJEPA; [D] derived for this project (`docs/design/plant.md`).

Plain numbers, without torch: a list of scenes, which hold their vehicles, needs no tensors.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from faultpath.plugin.system import Frozen

GRAVITY_MPS2 = 9.81
CONTROL_RATE_HZ = 20  # [P]
CONTROL_DT_S = 1 / CONTROL_RATE_HZ
PLANT_RATE_HZ = 500  # rate of the inner loop and of the integration
STEPS_PER_CONTROL = PLANT_RATE_HZ // CONTROL_RATE_HZ
PLANT_DT_S = 1 / PLANT_RATE_HZ
COLLISION_RADIUS_M = 0.20  # sphere around the position [NavRL, sdf-nmpc use 0.2-0.3]

ARM_LENGTH_M = 0.15  # centre to motor, cross configuration [DA, also of mass 1 kg]
TORQUE_COEFFICIENT_M = 0.022  # yaw torque per thrust of a rotor, N m / N [AF]
MOTOR_THRUST_MAX_N = 11.5  # per motor; thrust-to-weight 4.69 at 1 kg as [AF], 4 x 8.5 N at 0.75 kg
COLLECTIVE_MAX_N = 4 * MOTOR_THRUST_MAX_N
RATE_LIMIT_RADPS = (6.0, 6.0, 3.0)  # roll, pitch, yaw [within AF's 10/10/4 and DA's limits]
RATE_GAIN_PER_S = (20.0, 20.0, 10.0)  # rate controller's K, about AF's blackbird tuning

NOMINAL_MASS_KG = 1.0  # [DA]
NOMINAL_INERTIA_KGM2 = (0.010, 0.010, 0.018)  # [DA: 0.01, 0.01, 0.02]
NOMINAL_MOTOR_TIME_CONSTANT_S = 0.04  # [AF: 0.033]
NOMINAL_DRAG_KGPS = (0.30, 0.30, 0.30)  # [AF blackbird: 0.26, 0.26, 0.30; D]
"""Nominal `c_lin` of the wind map as well: its z must not be zero or wind is not observable."""

MIN_THRUST_TO_WEIGHT = 1.5

Range = tuple[float, float]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class VehicleParameters(Frozen, allow_inf_nan=False):
    """One vehicle as plain numbers, fit for a JSON file; a batch of them is a `Vehicle`."""

    mass_kg: Positive = NOMINAL_MASS_KG
    thrust_scale: Positive = 1.0
    torque_scale: Positive = 1.0
    inertia_kgm2: tuple[Positive, Positive, Positive] = NOMINAL_INERTIA_KGM2
    motor_time_constant_s: Positive = NOMINAL_MOTOR_TIME_CONSTANT_S
    drag_kgps: tuple[Positive, Positive, Positive] = NOMINAL_DRAG_KGPS

    @property
    def thrust_to_weight(self) -> float:
        """Largest realised thrust over weight."""
        return COLLECTIVE_MAX_N * self.thrust_scale / (self.mass_kg * GRAVITY_MPS2)

    @property
    def is_rigid(self) -> bool:
        """Whether a body can have these moments: none exceeds the sum of the other two."""
        return 2 * max(self.inertia_kgm2) <= sum(self.inertia_kgm2)


@dataclass(frozen=True)
class VehicleRanges:
    """Uniform randomisation per episode; relative ranges are about the nominal vehicle."""

    mass: float = 0.5  # relative [P]
    thrust_scale: float = 0.5  # relative [P]
    torque_scale: float = 0.5  # relative [P]
    inertia: float = 0.3  # relative, each axis by itself [SJ]
    motor_time_constant_s: Range = (0.02, 0.08)  # [SJ]
    drag_kgps: tuple[Range, Range, Range] = ((0.1, 0.5), (0.1, 0.5), (0.1, 0.5))  # by axis [SJ]


def draw(generator: np.random.Generator, ranges: VehicleRanges | None = None) -> VehicleParameters:
    """Return one vehicle drawn from `ranges` (default: those of the frozen scenes).

    A draw is repeated while its effective thrust-to-weight is below 1.5, which would hardly fly,
    or while its moments of inertia belong to no rigid body.
    """
    ranges = ranges or VehicleRanges()
    x_kgps, y_kgps, z_kgps = ranges.drag_kgps

    def about(nominal: float, relative: float) -> float:
        return nominal * (1 + relative * generator.uniform(-1, 1))

    while True:
        parameters = VehicleParameters(
            mass_kg=about(NOMINAL_MASS_KG, ranges.mass),
            thrust_scale=about(1.0, ranges.thrust_scale),
            torque_scale=about(1.0, ranges.torque_scale),
            inertia_kgm2=(
                about(NOMINAL_INERTIA_KGM2[0], ranges.inertia),
                about(NOMINAL_INERTIA_KGM2[1], ranges.inertia),
                about(NOMINAL_INERTIA_KGM2[2], ranges.inertia),
            ),
            motor_time_constant_s=generator.uniform(*ranges.motor_time_constant_s),
            drag_kgps=(
                generator.uniform(*x_kgps),
                generator.uniform(*y_kgps),
                generator.uniform(*z_kgps),
            ),
        )
        if parameters.thrust_to_weight >= MIN_THRUST_TO_WEIGHT and parameters.is_rigid:
            return parameters
