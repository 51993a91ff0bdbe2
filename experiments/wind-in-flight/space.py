"""Space of the search, and the platform of a point of it."""

from typing import Any

from faultpath_quadrotor.perception import PerceptionSettings
from faultpath_quadrotor.planners import CostWeights, SamplerSettings
from faultpath_quadrotor.plant.wind import WindLevel, Winds
from faultpath_quadrotor.platform import (
    ControllerSettings,
    FlightSettings,
    PerturbationSettings,
    PlannerSettings,
    Platform,
)
from faultpath_quadrotor.vehicle import VehicleRanges

from faultpath.core.streams import generator

SPACE: dict[str, tuple[float, float]] = {
    "goal_running": (0.1, 0.8),
    "thrust_effort": (2.0, 40.0),
    "goal": (4.0, 20.0),
    "risk": (5.0, 80.0),
    "rate_effort": (0.05, 3.0),
    "rate_sigma": (0.6, 2.4),
    "temperature": (0.04, 0.2),
    "margin_m": (0.2, 0.5),
    "unseen_m": (0.2, 0.6),
    "drag_across_kgps": (0.3, 0.9),
    "drag_along_kgps": (0.3, 1.6),
    "drag_spread": (0.2, 0.6),
    "own_drag": (0.0, 1.0),
    "motor_low_s": (0.01, 0.03),
    "motor_high_s": (0.05, 0.1),
    "wind_mps2": (0.0, 3.0),
    "turbulence_mps2": (0.2, 2.4),
    "length_m": (4.0, 16.0),
    "gust": (0.0, 1.2),
    "elevation_deg": (10.0, 90.0),
    "moderate": (0.4, 0.75),
    "pool_mps": (3.0, 10.0),
    "pool_turbulence_mps": (0.0, 6.0),
    "strength": (0.0, 1.0),
    "wind_strength": (0.0, 1.0),
    "wind_reach": (1.0, 2.5),
    "residual_bound_mps2": (2.0, 10.0),
    "conditioning_scale": (0.25, 4.0),
}
"""Bounds. `wind_mps2` and `turbulence_mps2` are the accelerations that the mean wind and the
standard deviation of the turbulence of L3 cause across the nominal vehicle; `moderate` is L2 over
L3, `gust` the middle of the gust's peak over the mean wind, `pool_mps` the strongest mean wind in
training and `pool_turbulence_mps` the strongest turbulence there, 0 where it hangs on the mean as
in evaluation. `strength` is that of the collection in still air, from gentle (0) to as before (1),
`wind_strength` and `wind_reach` those of the pool with wind. `conditioning_scale` multiplies the
spread by which WM-U's calibration features are standardised."""

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
    "motor_low_s": 0.02,
    "motor_high_s": 0.08,
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
    "elevation_deg": 20.0,
    "pool_turbulence_mps": 0.0,
    "residual_bound_mps2": 8.0,
    "conditioning_scale": 1.0,
}
"""`k0`: the platform before the one that ships. Its spread of drag stands above the space's bound,
and stays the default because `s2` was given with it."""

S2: dict[str, Any] = FORMER | {
    "wind_mps2": 0.9,
    "turbulence_mps2": 1.0,
    "length_m": 12.0,
    "gust": 1.0,
    "pool_mps": 6.0,
}
"""The point that stands unless another is nearer by the written objective."""


class SearchedWinds(Winds):
    """Winds with what the platform's own do not choose."""

    elevation_deg: float = 20.0
    pool_turbulence_mps: float = 0.0

    @property
    def levels(self) -> dict[str, WindLevel]:
        """See `Winds.levels`."""
        return {
            f"L{i}": WindLevel(mean, self.elevation_deg) for i, mean in enumerate(self.means_mps)
        }

    def pool_series(
        self, collection_seed: int, episode: int, duration_s: float, rate_hz: float = 500
    ) -> Any:
        """See `Winds.pool_series`; the turbulence may be drawn apart from the mean."""
        if not self.pool_turbulence_mps:
            return super().pool_series(collection_seed, episode, duration_s, rate_hz)
        stream = generator("wind/collection", str(episode), collection_seed)
        level = WindLevel(stream.uniform(*self.pool_mean_mps), 90.0)
        strength = stream.uniform(0, self.pool_turbulence_mps)
        apart = self.model_copy(update={"turbulence": strength / max(level.mean_mps, 1e-3)})
        return apart.sample(stream, level, duration_s, rate_hz)


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
        winds=winds_of(point, means, turbulence),
        drag_kgps=(across, across, along),
        own_drag=point["own_drag"],
        ranges=VehicleRanges(
            motor_time_constant_s=(point["motor_low_s"], point["motor_high_s"]),
            drag_kgps=tuple((c * (1 - spread), c * (1 + spread)) for c in (across, across, along)),
        ),
        perception=PerceptionSettings(unseen_m=point["unseen_m"]),
        collection=collection_of(point["strength"]),
        wind_collection=collection_of(point["wind_strength"], point["wind_reach"]),
    )


def winds_of(point: dict[str, Any], means: tuple[float, ...], turbulence: float) -> Winds:
    """Return the winds of a point; the platform's own class where that says them all."""
    gust = point["gust"]
    settings: dict[str, Any] = {
        "means_mps": means,
        "pool_mean_mps": (0.0, point["pool_mps"]),
        "turbulence": round(turbulence, 3),
        "length_m": point["length_m"],
        "gust": (0.8 * gust, 1.2 * gust),
        "gust_onset_s": ONSETS[point["gust_onset_s"]],
    }
    more = {name: point[name] for name in ("elevation_deg", "pool_turbulence_mps")}
    if all(more[name] == FORMER[name] for name in more):
        return Winds(**settings)
    return SearchedWinds(**settings, **more)


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
