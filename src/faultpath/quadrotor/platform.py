"""Everything that describes a platform, as one value: what flies, in which air, planned how.

Its hash tells it from all others; `platforms` has those that are frozen. Nothing of it is global:
who needs a part is handed it.
"""

import hashlib
import json
from typing import Any, Self

from pydantic import BaseModel, ConfigDict, Field

from faultpath.quadrotor.flight_settings import FlightSettings
from faultpath.quadrotor.perception import PerceptionSettings, camera
from faultpath.quadrotor.planners import CostWeights, SamplerSettings
from faultpath.quadrotor.plant.wind import Winds
from faultpath.quadrotor.scenes.scene import Scene
from faultpath.quadrotor.vehicle import (
    NOMINAL_DRAG_KGPS,
    Positive,
    VehicleParameters,
    VehicleRanges,
)

CLEARANCE = "clearance"
TRAJECTORY = "gru-trajectory"
DRAG_OVER_NOMINAL = (1 / 3, 5 / 3)
"""Ends of the drag's range over its nominal value: those of the first platform."""


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class PlannerSettings(_Frozen):
    """Everything of the planner that a platform decides."""

    sampler: SamplerSettings = SamplerSettings()
    goal_running: float = Field(default=0.0, ge=0, le=1)
    """Share of the mean distance along the horizon in the distance that counts; the rest is that
    at its end. It decides how stiff the planner is in height."""
    weights: CostWeights = CostWeights()
    running: CostWeights = CostWeights(thrust_effort=5.0)
    """Of the planner `running`. A mean distance gains less from a change of thrust than the
    distance at the end does, so the same effort weight would weigh more."""
    temperature: float = 0.08
    """Fraction of the spread of the better half of the candidates' costs."""


class SceneVehicles(_Frozen):
    """What of the vehicle that a scene was drawn with flies; the rest is that of the nominal one.

    The same for all scenes. A drawn drag is taken in proportion to the nominal one.
    """

    drag_drawn: bool = True
    calibration_drawn: bool = True
    """Mass and thrust scale."""
    rest_drawn: bool = True
    """Torque scale, inertia, motor time constant."""


class Platform(_Frozen):
    """What the first platform is by default, field by field."""

    planner: PlannerSettings = PlannerSettings()
    winds: Winds = Winds()
    drag_kgps: tuple[Positive, Positive, Positive] = NOMINAL_DRAG_KGPS
    """Drag of the nominal vehicle, by body axis: the one that predictors and observers assume."""
    ranges: VehicleRanges = VehicleRanges()
    """What the vehicles of training episodes are drawn from."""
    scene_vehicles: SceneVehicles = SceneVehicles()
    perception: PerceptionSettings = PerceptionSettings()
    follows_motors: bool = False
    """Whether the true-parameter predictor replays executed commands to know its motors."""
    collection: FlightSettings = FlightSettings()

    @property
    def hash(self) -> str:
        """Hash of everything above and of the camera, which is the same on all platforms."""
        return _hash(self.described())

    def described(self) -> dict[str, Any]:
        """Return the platform as JSON values, with the camera."""
        return {"camera": camera.described(), **self.model_dump(mode="json")}

    def weights_hash(self, model: str) -> str:
        """Return a hash of what decides the data that a model of this name is fitted on.

        Models that differ in nothing else are shared by platforms: the planner's weights, for
        example, do not reach the training flights.
        """
        if model == CLEARANCE:
            return _hash(camera.described())
        if model == TRAJECTORY:  # it learns from flights in closed loop
            return self.hash
        parts = {"drag_kgps", "ranges", "collection"}
        content = self.model_dump(mode="json", include=parts)
        return _hash({**content, "pool_mean_mps": self.winds.pool_mean_mps})

    def scene(self, scene: Scene) -> Scene:
        """Return a scene with the vehicle that flies there on this platform."""
        drawn, which = scene.vehicle, self.scene_vehicles
        nominal = VehicleParameters(drag_kgps=self.drag_kgps)
        own: dict[str, Any] = {"drag_kgps": self.drag_kgps}
        if which.drag_drawn:
            pairs = zip(drawn.drag_kgps, self.drag_kgps, NOMINAL_DRAG_KGPS, strict=True)
            own["drag_kgps"] = tuple(
                kgps if here == first else kgps * here / first for kgps, here, first in pairs
            )
        for fields, kept in (
            (("mass_kg", "thrust_scale"), which.calibration_drawn),
            (("torque_scale", "inertia_kgm2", "motor_time_constant_s"), which.rest_drawn),
        ):
            own |= {name: getattr(drawn if kept else nominal, name) for name in fields}
        flown = VehicleParameters(**own)
        return scene if flown == drawn else scene.model_copy(update={"vehicle": flown})

    def with_drag(self, kgps: tuple[float, float, float]) -> Self:
        """Return the platform with another nominal drag, and the ranges about it in proportion."""
        low, high = DRAG_OVER_NOMINAL
        x, y, z = ((each * low, each * high) for each in kgps)
        ranges = VehicleRanges(**{**vars(self.ranges), "drag_kgps": (x, y, z)})
        return self.model_copy(update={"drag_kgps": kgps, "ranges": ranges})


def _hash(content: object) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]
