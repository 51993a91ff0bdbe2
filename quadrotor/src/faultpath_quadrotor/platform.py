"""The platform as one value: what flies, in which air, planned how.

Chosen as the one whose baselines are nearest the paper's; `docs/design/platform.md` says how.
"""

import hashlib
import json

from faultpath.plugin.system import Frozen
from faultpath_quadrotor.perception import PerceptionSettings, camera
from faultpath_quadrotor.planners import CostWeights, SamplerSettings
from faultpath_quadrotor.plant.wind import Winds
from faultpath_quadrotor.scenes.scene import Scene
from faultpath_quadrotor.vehicle import Positive, Range, VehicleRanges


class ControllerSettings(Frozen):
    """Ranges from which each episode, or each of its waypoints, draws uniformly."""

    arena_m: tuple[Range, Range, Range] = ((-4.5, 4.5), (-3.0, 3.0), (0.0, 3.0))
    """Box of the waypoints and the starts, the size of the scenes' arenas."""
    waypoints: int = 16
    """More than an episode of 6 s uses; the last one is kept."""
    speed_mps: Range = (1.0, 4.8)
    """Per waypoint: highest speed commanded. The planner's limit is 3.4 m/s (paper, Section IV-A);
    legs are too short to reach all of it, and a wind may push beyond it."""
    leg_s: Range = (0.6, 3.0)
    """Per waypoint: time after which the next one follows, reached or not."""
    arrival_m: float = 0.4
    heading_offset_rad: float = 0.8
    """Per waypoint: largest angle between the heading and the direction of travel."""
    position_gain_per_s: Range = (1.2, 2.5)
    velocity_gain_per_s: Range = (1.5, 3.5)
    attitude_gain_per_s: Range = (4.0, 9.0)
    heading_gain_per_s: Range = (0.5, 2.0)
    tilt_limit_deg: Range = (25.0, 60.0)
    drag_share: Range = (0.0, 1.0)
    """How much of drag and wind the controller makes up for in advance."""


class PerturbationSettings(Frozen):
    """Ranges of the perturbations; what an episode gets of them is drawn for it.

    Spread and correlation are those of the planner's candidates (`planner.SamplerSettings`): a
    predictor is asked about such commands. The rest is derived (`docs/design/learning.md`).
    """

    thrust_sigma: float = 0.22
    """Largest standard deviation of the thrust, as a fraction of the hover thrust."""
    rate_sigma_radps: tuple[float, float, float] = (1.0, 1.0, 0.4)
    """Largest standard deviations of the body rates."""
    correlation: tuple[float, float] = (0.6, 0.85)
    """Range of the correlation between neighbouring steps."""
    clean_share: float = 0.15
    """Share of the episodes whose strength is at most `clean_strength`; else it is up to 1."""
    clean_strength: float = 0.1
    jitter: float = 0.3
    """Largest standard deviation of the white part, in units of the correlated one."""
    pulses_per_s: float = 0.5
    """Steps and doublets on one axis, on average."""
    pulse_steps: tuple[int, int] = (2, 6)
    """Length of a step and of each half of a doublet."""
    pulse_sigmas: tuple[float, float] = (1.0, 2.5)
    """Their height in units of the correlated part's standard deviation."""
    holds_per_s: float = 0.3
    """Stretches without feedback, on average in an episode that is not clean: a candidate of the
    planner has none over its whole horizon."""
    hold_steps: tuple[int, int] = (2, 8)


class FlightSettings(Frozen):
    """Everything that decides an episode beside its seed, its pool and the vehicle's ranges."""

    controller: ControllerSettings = ControllerSettings()
    perturbation: PerturbationSettings = PerturbationSettings()
    start_speed_mps: float = 3.0
    """The start velocity is uniform in a ball of this radius."""
    start_tilt_deg: float = 30.0
    start_rate_radps: tuple[float, float, float] = (1.5, 1.5, 0.8)
    """Start rates are uniform within plus and minus this."""
    volume_m: tuple[Range, Range, Range] = ((-14.0, 14.0), (-13.0, 13.0), (-10.0, 13.0))
    """An episode ends outside: about 10 m beyond the arena. Free space, without a floor."""
    speed_limit_mps: float = 12.0
    tilt_limit_deg: float = 120.0


CLEARANCE = "clearance"
TRAJECTORY = "gru-trajectory"


class PlannerSettings(Frozen):
    """Everything of the planner that the platform decides."""

    sampler: SamplerSettings = SamplerSettings()
    weights: CostWeights = CostWeights()
    temperature: float = 0.1
    """Fraction of the spread of the better half of the candidates' costs."""


def _about(kgps: float) -> tuple[float, float]:
    return (kgps * (1 - _DRAG_SPREAD), kgps * (1 + _DRAG_SPREAD))


_DRAG_SPREAD = 2 / 3
"""Spread of training vehicles about nominal drag, a fraction; the paper gives no range."""
_DATA = {"drag_kgps", "ranges", "collection"}
"""Fields that decide the data that models are fitted on, beside the winds."""


class Platform(Frozen):
    """Vehicle, winds, planner, perception and training flights."""

    planner: PlannerSettings = PlannerSettings()
    winds: Winds = Winds()
    drag_kgps: tuple[Positive, Positive, Positive] = (0.5, 0.5, 1.2)
    """Nominal drag, by body axis: what scenes have, and what predictors and observers assume."""
    ranges: VehicleRanges = VehicleRanges(drag_kgps=(_about(0.5), _about(0.5), _about(1.2)))
    """Ranges that the vehicles of training episodes are drawn from."""
    perception: PerceptionSettings = PerceptionSettings()
    collection: FlightSettings = FlightSettings()
    """How the training episodes fly."""

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
        content = self.model_dump(mode="json", include=_DATA)
        winds = self.winds.model_dump(mode="json", exclude={"means_mps"})
        return _hash({**content, "winds": winds})

    def scene(self, scene: Scene) -> Scene:
        """Return a scene with the vehicle that flies: the one drawn for it, with nominal drag."""
        vehicle = scene.vehicle.model_copy(update={"drag_kgps": self.drag_kgps})
        return scene.model_copy(update={"vehicle": vehicle})


def _hash(content: object) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


PLATFORM = Platform()
