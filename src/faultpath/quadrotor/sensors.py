"""What the sources of the interface produce at a step: readings with their time of validity."""

from dataclasses import dataclass

import torch
from torch import Tensor

from faultpath.quadrotor.state import State
from faultpath.quadrotor.vehicle_batch import Vehicle
from faultpath.quadrotor.world import World
from faultpath.taps import Reading

SOURCES = {
    "mass": "mass_estimate",
    "thrust_scale": "thrust_scale_estimate",
    "position": "position_estimate",
    "velocity": "velocity_estimate",
    "attitude": "attitude_estimate",
    "body_rate": "body_rate_measurement",
    "goal": "mission_goal",
    "physics": "true_physics",
    "depth": "depth_image",
}
"""Source of each channel that has only one."""


@dataclass(frozen=True)
class Sensors:
    """Readings of one step, scenes first: `[B, ...]`, as taps want them."""

    readings: dict[str, Reading]
    """By channel."""
    true_wind: Reading
    zero_wind: Reading

    @classmethod
    def read(cls, world: World, depth: Tensor | None = None) -> "Sensors":
        """Take the readings of all scenes, without the lanes that only fill the batch up.

        `depth` `[B, 36, 64]` is what the scenes' cameras see, if there are any.
        """
        count, step = world.count, world.step
        state = world.state
        values = {
            "mass": world.vehicle.mass_kg,
            "thrust_scale": world.vehicle.thrust_scale,
            "position": state.position,
            "velocity": state.velocity,
            "attitude": state.rotation,
            "body_rate": state.rate,
            "goal": world.goal,
            "physics": _physics(world.vehicle, world.plant_state.thrusts),
        }
        wind = scenes_first(world.wind_mps, count)
        rows = {channel: scenes_first(value, count) for channel, value in values.items()}
        if depth is not None:
            rows["depth"] = depth
        return cls(
            readings={
                channel: Reading(value, SOURCES[channel], step) for channel, value in rows.items()
            },
            true_wind=Reading(wind, "true_wind", step),
            zero_wind=Reading(torch.zeros_like(wind), "zero_wind", step),
        )


def scenes_first(value: Tensor, count: int) -> Tensor:
    """Turn `[..., L]` lanes into `[B, ...]` scenes."""
    return value[..., :count].movedim(-1, 0)


def lanes_last(value: Tensor, lanes: Tensor) -> Tensor:
    """Turn `[B, ...]` scenes into contiguous `[..., L]` lanes."""
    return value.movedim(0, -1)[..., lanes]


def initial_state(parts: dict[str, Tensor], lanes: Tensor) -> State:
    """Assemble a state from delivered readings `[B, ...]`."""
    return State(*(lanes_last(parts[name], lanes) for name in STATE_CHANNELS))


STATE_CHANNELS = ("position", "velocity", "attitude", "body_rate")


def _physics(vehicle: Vehicle, motors: Tensor) -> Tensor:
    return torch.cat(
        [
            vehicle.inertia_kgm2,
            vehicle.torque_scale[None],
            vehicle.motor_time_constant_s[None],
            vehicle.drag_kgps,
            motors.sum(0, keepdim=True),
        ]
    )
