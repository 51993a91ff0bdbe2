"""What the search may choose, and the platform that a choice makes."""

from typing import Any

from faultpath_quadrotor.perception import PerceptionSettings
from faultpath_quadrotor.planners import CostWeights, SamplerSettings
from faultpath_quadrotor.plant.wind import Winds
from faultpath_quadrotor.platform import (
    ControllerSettings,
    FlightSettings,
    PerturbationSettings,
    PlannerSettings,
    Platform,
)
from faultpath_quadrotor.vehicle import VehicleRanges

SPACE: dict[str, dict[str, Any]] = {
    "goal_running": {"low": 0.1, "high": 0.8, "step": 0.05},
    "thrust_effort": {"low": 2.0, "high": 40.0, "log": True},
    "goal": {"low": 4.0, "high": 20.0, "log": True},
    "risk": {"low": 5.0, "high": 80.0, "log": True},
    "rate_effort": {"low": 0.05, "high": 3.0, "log": True},
    "rate_sigma": {"low": 0.6, "high": 2.4, "step": 0.2},
    "temperature": {"low": 0.04, "high": 0.2, "log": True},
    "margin_m": {"low": 0.2, "high": 0.5, "step": 0.05},
    "unseen_m": {"low": 0.2, "high": 0.6, "step": 0.05},
    "drag_across_kgps": {"low": 0.3, "high": 0.9, "step": 0.1},
    "drag_along_kgps": {"low": 0.6, "high": 1.6, "step": 0.2},
    "drag_spread": {"low": 0.3, "high": 0.95, "step": 0.05},
    "own_drag": {"low": 0.0, "high": 1.0, "step": 0.25},
    "wind_mps2": {"low": 0.0, "high": 3.0, "step": 0.1},
    "turbulence_mps2": {"low": 0.2, "high": 2.4, "step": 0.1},
    "gust": {"low": 0.0, "high": 1.0, "step": 0.25},
    "gust_onset_s": {"choices": ["early", "late"]},
    "length_m": {"low": 1.0, "high": 10.0, "log": True},
    "moderate": {"low": 0.4, "high": 0.75, "step": 0.05},
    "pool_mps": {"low": 4.0, "high": 24.0, "step": 1.0},
    "strength": {"low": 0.0, "high": 1.0, "step": 0.25},
    "wind_strength": {"low": 0.0, "high": 1.0, "step": 0.25},
    "wind_reach": {"low": 1.0, "high": 2.5, "step": 0.25},
}
"""`wind_mps2` and `turbulence_mps2` are the accelerations that the mean wind and the standard
deviation of the turbulence of L3 cause across the nominal vehicle; `moderate` is L2 over L3, `gust`
the middle of the gust's peak over the mean wind, `pool_mps` the strongest mean wind in training. `strength` is that of the collection in still air, from gentle (0)
to as before (1), `wind_strength` that of the pool with wind; the first points had one for both."""

ONSETS = {"early": (0.0, 2.0), "late": (0.5, 4.0)}
FORMER: dict[str, Any] = {
    "goal_running": 0.4,
    "thrust_effort": 12.0,
    "goal": 8.0,
    "risk": 36.0,
    "rate_effort": 0.4,
    "rate_sigma": 1.0,
    "temperature": 0.1,
    "margin_m": 0.3,
    "unseen_m": 0.3,
    "drag_across_kgps": 0.5,
    "drag_along_kgps": 1.2,
    "drag_spread": 2 / 3,
    "own_drag": 0.0,
    "wind_mps2": 1.6,
    "turbulence_mps2": 0.32,
    "gust": 0.5,
    "gust_onset_s": "late",
    "length_m": 4.0,
    "moderate": 0.55,
    "pool_mps": 6.0,
    "strength": 1.0,
    "wind_strength": 1.0,
    "wind_reach": 1.0,
}
"""The platform before."""

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
    mean = max(point["wind_mps2"], 0.1) / across
    turbulence = point["turbulence_mps2"] / across / mean
    light = 0.26 / 0.55 * point["moderate"]
    means = tuple(round(mean * share, 3) for share in (0.0, light, point["moderate"], 1.0))
    gust = point["gust"]
    weighed = ("thrust_effort", "rate_effort", "goal", "risk", "margin_m")
    sigma, spread = point["rate_sigma"], point["drag_spread"]
    return Platform(
        planner=PlannerSettings(
            sampler=SamplerSettings(rate_sigma_radps=(sigma, sigma, 0.4)),
            weights=CostWeights(
                running=point["goal_running"], **{name: point[name] for name in weighed}
            ),
            temperature=point["temperature"],
        ),
        winds=Winds(
            means_mps=means,
            pool_mean_mps=(0.0, point["pool_mps"]),
            turbulence=round(turbulence, 3),
            length_m=point["length_m"],
            gust=(0.8 * gust, 1.2 * gust),
            gust_onset_s=ONSETS[point["gust_onset_s"]],
        ),
        drag_kgps=(across, across, along),
        own_drag=point["own_drag"],
        ranges=VehicleRanges(
            drag_kgps=tuple((c * (1 - spread), c * (1 + spread)) for c in (across, across, along))
        ),
        perception=PerceptionSettings(unseen_m=point["unseen_m"]),
        collection=collection_of(point["strength"]),
        wind_collection=collection_of(point["wind_strength"], point["wind_reach"]),
    )


def collection_of(strength: float, reach: float = 1.0) -> FlightSettings:
    """Return how hard the collection flies, at 1 as before, at 0 gently, and how far and fast."""
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
    if reach != 1:
        low, high = controller["speed_mps"]
        controller["speed_mps"] = (low, high * reach)
        controller["arena_m"] = tuple((a * reach, b * reach) for a, b in first.controller.arena_m)
    return first.model_copy(
        update={
            "controller": ControllerSettings(**controller),
            "perturbation": PerturbationSettings(**found),
            "start_speed_mps": first.start_speed_mps * reach,
        }
    )


def _between(low: float, high: float, share: float) -> float:
    return high if share == 1 else round(low + share * (high - low), 6)
