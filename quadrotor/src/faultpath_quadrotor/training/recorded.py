"""Records of flights at every control instant, whoever flew them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from faultpath_quadrotor.device import CPU
from faultpath_quadrotor.plant import PlantState
from faultpath_quadrotor.training.pool import read_pool
from faultpath_quadrotor.vehicle import VehicleParameters

SIGNALS = {
    "position": slice(0, 3),
    "velocity": slice(3, 6),
    "rotation": slice(6, 15),
    "rate": slice(15, 18),
    "command": slice(18, 22),
    "wind_mps": slice(22, 25),
    "motor_thrust_n": slice(25, 26),
}
"""Components of the signals recorded at each control instant."""
COMPONENTS = 26


@dataclass(frozen=True)
class Flights:
    """Records of a batch of episodes."""

    values: np.ndarray
    """float32 [C, N + 1, B] at the control instants, in the order of `SIGNALS`; a command
    stands at the instant from which it acts, and is not a number at the last one."""
    steps: np.ndarray
    """Control steps of each episode before it ended, [B]. Its states are 0..steps; what comes
    after them is not part of it."""
    vehicles: tuple[VehicleParameters, ...]

    def tensors(self) -> dict[str, Tensor]:
        """Return what a pool keeps: the instants of all episodes, [R, C], lengths and vehicles."""
        kept = np.arange(self.values.shape[1]) <= self.steps[:, None]
        rows = self.values.transpose(2, 1, 0)[kept]
        rows[np.cumsum(self.steps + 1) - 1, SIGNALS["command"]] = np.nan  # none acts after the end
        columns = {"values": rows, "steps": self.steps.astype(np.int64)}
        for name in VehicleParameters.model_fields:
            columns[name] = np.array([getattr(vehicle, name) for vehicle in self.vehicles])
        return {name: torch.from_numpy(column) for name, column in columns.items()}


@dataclass(frozen=True)
class FlightData:
    """Recorded episodes in memory, wherever they were flown."""

    name: str
    values: np.ndarray
    """float32 [C, R] in the order of `SIGNALS`; episodes one after the other."""
    steps: np.ndarray
    """Control steps of each episode, [E]; it has one row more than steps."""
    vehicles: dict[str, np.ndarray]
    """Fields of `Vehicle` by name, float64, [E] or [3, E]."""

    @property
    def first_row(self) -> np.ndarray:
        """Return the row of each episode's first instant, [E]."""
        return np.concatenate(([0], np.cumsum(self.steps + 1)[:-1]))

    @classmethod
    def read(cls, path: Path) -> FlightData:
        """Read a pool; `UserError` when it is missing, unfinished or damaged."""
        return cls.of(*read_pool(path))

    @classmethod
    def of(cls, name: str, tensors: Mapping[str, Tensor]) -> FlightData:
        """Return the flights in the tensors of a pool or of a part."""
        columns = {name: value.numpy().T for name, value in tensors.items()}
        return cls(
            name=name,
            values=np.ascontiguousarray(columns["values"]),
            steps=columns["steps"],
            vehicles={name: columns[name] for name in VehicleParameters.model_fields},
        )


def blank_values(steps: int, count: int) -> NDArray[np.float32]:
    """Return `Flights.values` of flights of at most so many steps, all not a number yet."""
    return np.full((COMPONENTS, steps + 1, count), np.nan, np.float32)


def record(
    values: NDArray[np.float32],
    step: int,
    plant_state: PlantState,
    wind_mps: Tensor,
    command: Tensor | None = None,
) -> None:
    """Fill in one control instant from lanes of which the first are the flights.

    `wind_mps` is `[3, L]`, `command` `[4, L]`; `None` where none acts any more.
    """
    state = plant_state.state
    parts = (
        state.position,
        state.velocity,
        state.rotation.flatten(0, 1),
        state.rate,
        torch.full_like(wind_mps[:1], torch.nan).expand(4, -1) if command is None else command,
        wind_mps,
        plant_state.thrusts.sum(0, keepdim=True),
    )
    values[:, step] = torch.cat(parts).float()[:, : values.shape[2]].to(CPU).numpy()
