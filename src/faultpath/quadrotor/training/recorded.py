"""What a flight leaves behind at every control instant, whoever flew it."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from faultpath.loop import Instant, Port
from faultpath.quadrotor.device import CPU
from faultpath.quadrotor.plant import PlantState
from faultpath.quadrotor.vehicle import VehicleParameters

ACTION = Port("action", "actuators")
SIGNALS = {
    "position": ("x_m", "y_m", "z_m"),
    "velocity": ("vx_mps", "vy_mps", "vz_mps"),
    "rotation": tuple(f"r{i}{j}" for i in range(3) for j in range(3)),
    "rate": ("roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps"),
    "command": ("thrust_n", "roll_command_radps", "pitch_command_radps", "yaw_command_radps"),
    "wind_mps": ("wind_x_mps", "wind_y_mps", "wind_z_mps"),
    "motor_thrust_n": ("motor_thrust_n",),
}
"""What is recorded at each control instant, and the names of its components."""
COMPONENTS = tuple(name for names in SIGNALS.values() for name in names)


@dataclass(frozen=True)
class Flights:
    """What a batch of episodes left behind."""

    values: np.ndarray
    """float32 [C, N + 1, B] at the control instants, in the order of `COMPONENTS`; a command
    stands at the instant from which it acts, and is not a number at the last one."""
    steps: np.ndarray
    """Control steps of each episode before it ended, [B]. Its states are 0..steps; what comes
    after them is not part of it."""
    vehicles: tuple[VehicleParameters, ...]


class Recordable(Protocol):
    """A batch in flight, lanes last."""

    lanes: Tensor
    plant_state: PlantState

    @property
    def wind_mps(self) -> Tensor:
        """Wind at this moment, `[3, L]`."""
        ...


Flown = TypeVar("Flown", bound=Recordable)


def record(
    instants: Iterable[tuple[Instant, Flown]], count: int, steps: int
) -> tuple[NDArray[np.float32], Flown]:
    """Return the `Flights.values` of `count` flights of at most so many steps, and their end.

    Each instant comes with what flies at it. Where all flights end earlier, what would come after
    is not a number.
    """
    now = None
    values = np.full((len(COMPONENTS), steps + 1, count), np.nan, np.float32)
    for instant, now in instants:
        state = now.plant_state.state
        command = state.position.new_full((4, len(now.lanes)), torch.nan)
        if ACTION in instant.inputs:
            command = instant.inputs[ACTION].T[:, now.lanes]
        parts = (
            state.position,
            state.velocity,
            state.rotation.flatten(0, 1),
            state.rate,
            command,
            now.wind_mps,
            now.plant_state.thrusts.sum(0, keepdim=True),
        )
        values[:, instant.step] = torch.cat(parts).float()[:, :count].to(CPU).numpy()
    assert now is not None
    return values, now
