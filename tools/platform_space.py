"""What the platform search may choose, and the platform that a choice makes."""

from typing import Any

from faultpath.quadrotor.flight_settings import (
    ControllerSettings,
    FlightSettings,
    PerturbationSettings,
)
from faultpath.quadrotor.perception import PerceptionSettings
from faultpath.quadrotor.planners import CostWeights
from faultpath.quadrotor.plant.wind import Winds
from faultpath.quadrotor.platform import PlannerSettings, Platform, SceneVehicles
from faultpath.quadrotor.platforms import FIRST

SPACE: dict[str, dict[str, Any]] = {
    "goal_running": {"low": 0.1, "high": 0.8, "step": 0.05},
    "thrust_effort": {"low": 2.0, "high": 40.0, "log": True},
    "goal": {"low": 4.0, "high": 20.0, "log": True},
    "risk": {"low": 5.0, "high": 80.0, "log": True},
    "rate_effort": {"low": 0.2, "high": 3.0, "log": True},
    "temperature": {"low": 0.04, "high": 0.2, "log": True},
    "margin_m": {"low": 0.2, "high": 0.5, "step": 0.05},
    "drag_across_kgps": {"low": 0.3, "high": 0.8, "step": 0.1},
    "drag_along_kgps": {"low": 0.6, "high": 1.6, "step": 0.2},
    "wind_mps2": {"low": 1.0, "high": 2.4, "step": 0.1},
    "drag_drawn": {"choices": [True, False]},
    "calibration_drawn": {"choices": [True, False]},
    "rest_drawn": {"choices": [True, False]},
    "unseen_m": {"low": 0.2, "high": 0.6, "step": 0.05},
    "altitude_limits": {"choices": [True, False]},
    "remembered": {"choices": [0, 2]},
    "strength": {"low": 0.0, "high": 1.0, "step": 0.25},
}
"""Ranges and choices. `wind_mps2` is the acceleration that the mean wind of L3 causes across the
nominal vehicle; the other levels keep their ratio to L3. `strength` is that of the collection, from
the gentle one (0) to that of the first platform (1)."""

STARTS: list[dict[str, Any]] = [
    {
        "goal_running": 0.35,
        "thrust_effort": 5.0,
        "goal": 10.0,
        "risk": 40.0,
        "rate_effort": 0.5,
        "temperature": 0.08,
        "margin_m": 0.35,
        "drag_across_kgps": 0.5,
        "drag_along_kgps": 1.2,
        "wind_mps2": 1.6,
        "drag_drawn": False,
        "calibration_drawn": True,
        "rest_drawn": True,
        "unseen_m": 0.25,
        "altitude_limits": limited,
        "remembered": 0,
        "strength": strength,
    }
    for limited, strength in ((False, 1.0), (False, 0.0), (True, 0.0))
]
"""Where the search begins: the look that gave rise to it, gentler collection, and known heights."""

_SHARES = [mean / FIRST.winds.means_mps[3] for mean in FIRST.winds.means_mps]
_GENTLE = {
    "thrust_sigma": 0.08,
    "rate_sigma_radps": (0.4, 0.4, 0.2),
    "pulses_per_s": 0.1,
    "holds_per_s": 0.06,
    "speed_mps": (1.0, 3.4),
    "tilt_limit_deg": (25.0, 45.0),
}


def platform_of(point: dict[str, Any]) -> Platform:
    """Return the platform of a point of the space."""
    across, along = point["drag_across_kgps"], point["drag_along_kgps"]
    strongest = point["wind_mps2"] / across
    means = tuple(round(strongest * share, 3) for share in _SHARES)
    # Winds of the pool keep their accelerations too.
    pool = (0.0, round(FIRST.winds.pool_mean_mps[1] * FIRST.drag_kgps[0] / across, 1))
    weighed = ("thrust_effort", "rate_effort", "goal", "risk", "margin_m")
    weights = CostWeights(**{name: point[name] for name in weighed})
    return FIRST.with_drag((across, across, along)).model_copy(
        update={
            "planner": PlannerSettings(
                goal_running=point["goal_running"],
                temperature=point["temperature"],
                weights=weights,
                running=weights.model_copy(update={"thrust_effort": 5.0}),
            ),
            "winds": Winds(means_mps=means, pool_mean_mps=pool),
            "scene_vehicles": SceneVehicles(
                drag_drawn=point["drag_drawn"],
                calibration_drawn=point["calibration_drawn"],
                rest_drawn=point["rest_drawn"],
            ),
            "perception": PerceptionSettings(
                **{name: point[name] for name in ("unseen_m", "altitude_limits", "remembered")}
            ),
            "follows_motors": True,
            "collection": collection_of(point["strength"]),
        }
    )


def collection_of(strength: float) -> FlightSettings:
    """Return how hard the collection flies: at 1 as on the first platform, at 0 gently."""
    first = FlightSettings()
    found: dict[str, Any] = {}
    for name, low in _GENTLE.items():
        holder = first.controller if hasattr(first.controller, name) else first.perturbation
        high = getattr(holder, name)
        found[name] = (
            tuple(_between(a, b, strength) for a, b in zip(low, high, strict=True))
            if isinstance(low, tuple)
            else _between(low, high, strength)
        )
    controller = {name: found.pop(name) for name in ("speed_mps", "tilt_limit_deg")}
    return first.model_copy(
        update={
            "controller": ControllerSettings(**controller),
            "perturbation": PerturbationSettings(**found),
        }
    )


def _between(low: float, high: float, share: float) -> float:
    return high if share == 1 else round(low + share * (high - low), 6)
