"""The platform as one value: what flies, in which air, planned how.

Chosen as the one whose baselines are nearest the paper's; `docs/design/platform.md` says how.
"""

import hashlib
import json

from pydantic import BaseModel, ConfigDict

from faultpath_quadrotor.flight_settings import FlightSettings
from faultpath_quadrotor.perception import PerceptionSettings, camera
from faultpath_quadrotor.planners import CostWeights, SamplerSettings
from faultpath_quadrotor.plant.wind import Winds
from faultpath_quadrotor.scenes.scene import Scene
from faultpath_quadrotor.vehicle import Positive, VehicleRanges

CLEARANCE = "clearance"
TRAJECTORY = "gru-trajectory"


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class PlannerSettings(_Frozen):
    """Everything of the planner that the platform decides."""

    sampler: SamplerSettings = SamplerSettings()
    weights: CostWeights = CostWeights()
    temperature: float = 0.1
    """Fraction of the spread of the better half of the candidates' costs."""


def _about(kgps: float) -> tuple[float, float]:
    return (kgps * (1 / 3), kgps * (5 / 3))


class Platform(_Frozen):
    """Vehicle, winds, planner, perception and training flights."""

    planner: PlannerSettings = PlannerSettings()
    winds: Winds = Winds()
    drag_kgps: tuple[Positive, Positive, Positive] = (0.5, 0.5, 1.2)
    """Drag of the vehicle, by body axis: the one that flies, and that predictors and observers
    assume."""
    ranges: VehicleRanges = VehicleRanges(drag_kgps=(_about(0.5), _about(0.5), _about(1.2)))
    """What the vehicles of training episodes are drawn from."""
    perception: PerceptionSettings = PerceptionSettings()
    collection: FlightSettings = FlightSettings()

    @property
    def hash(self) -> str:
        """Hash of everything above and of the camera."""
        return _hash({"camera": camera.described(), **self.model_dump(mode="json")})

    def weights_hash(self, model: str) -> str:
        """Return a hash of what decides the data that a model of this name is fitted on."""
        if model == CLEARANCE:
            return _hash(camera.described())
        if model == TRAJECTORY:  # it learns from flights in closed loop
            return self.hash
        parts = {"drag_kgps", "ranges", "collection"}
        content = self.model_dump(mode="json", include=parts)
        return _hash({**content, "pool_mean_mps": self.winds.pool_mean_mps})

    def scene(self, scene: Scene) -> Scene:
        """Return a scene with the vehicle that flies there: the one drawn for it, but for drag."""
        vehicle = scene.vehicle.model_copy(update={"drag_kgps": self.drag_kgps})
        return scene.model_copy(update={"vehicle": vehicle})


def _hash(content: object) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


PLATFORM = Platform()
