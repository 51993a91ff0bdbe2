"""The windows that predictors and the reconstruction learn from: 12 steps of history, 20 ahead."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from faultpath.plugin.training import validates
from faultpath_quadrotor.predictors import Physics, Predictor
from faultpath_quadrotor.predictors.base import Take, history, predictor_inputs
from faultpath_quadrotor.predictors.module import STEPS
from faultpath_quadrotor.predictors.rollout import unroll
from faultpath_quadrotor.state import State
from faultpath_quadrotor.training.recorded import SIGNALS, FlightData

HISTORY = STEPS
HORIZON = 20  # paper, Section IV-A
COMMANDS = HISTORY + HORIZON
STRIDE = 29
"""Least spacing of the windows of an episode: four in one of 6 s."""
COUNTS = {"nominal": 25_684, "wind": 53_344}
"""Windows of the pools in all, before the split (paper, Section IV-A and appendix)."""


@dataclass(frozen=True)
class Windows:
    """Windows as float32 tensors, components first, then time, then the W windows.

    Command k acts from state k to state k + 1. The present is state 12: history is states and
    commands 0..11, the future is commands 12..31 and states 13..32.
    """

    position: Tensor
    """World frame, m, [3, 33, W]."""
    velocity: Tensor
    """World frame, m/s, [3, 33, W]."""
    rotation: Tensor
    """Body to world, [3, 3, 33, W]."""
    rate: Tensor
    """Body frame, rad/s, [3, 33, W]."""
    command: Tensor
    """Collective thrust in N and body rates in rad/s, [4, 32, W]."""
    wind_mps: Tensor
    """World frame, at the control instants, [3, 33, W]."""
    mass_kg: Tensor
    """[W]"""
    thrust_scale: Tensor
    """[W]"""
    inertia_kgm2: Tensor
    """[3, W]"""
    torque_scale: Tensor
    """[W]"""
    motor_time_constant_s: Tensor
    """[W]"""
    drag_kgps: Tensor
    """[3, W]"""
    motor_thrust_n: Tensor
    """Sum of the motors before the thrust scale, [33, W]."""
    ids: tuple[str, ...]
    """Pool, episode, and window in the episode: "nominal/00012/2"."""

    def __len__(self) -> int:
        return len(self.ids)

    def take(self, index: Tensor) -> Windows:
        """Return the windows that `index` (long or bool, [n]) picks."""
        if index.dtype == torch.bool:
            index = index.nonzero()[:, 0]
        return self._build(
            lambda name: getattr(self, name).index_select(-1, index),
            tuple(self.ids[i] for i in index.tolist()),
        )

    @property
    def calibration(self) -> dict[str, Tensor]:
        """The true calibration by channel, `[W]` each."""
        return {"mass": self.mass_kg, "thrust_scale": self.thrust_scale}

    def state(self, k: int) -> State:
        """Return state `k` (0..32) of every window."""
        return State(
            self.position[:, k], self.velocity[:, k], self.rotation[:, :, k], self.rate[:, k]
        )

    def physics(self, k: int) -> Physics:
        """Return the vehicles' own parameters, and what their motors hold at state `k`."""
        return Physics(
            self.inertia_kgm2,
            self.torque_scale,
            self.motor_time_constant_s,
            self.drag_kgps,
            self.motor_thrust_n[k],
        )

    def split(self, validation_share: float = 0.05) -> tuple[Windows, Windows]:
        """Return the windows for training and those for validation, by episode.

        Pool and episode decide alone, whatever else is collected, joined or taken.
        """
        episodes = [name.rpartition("/")[0] for name in self.ids]
        held_out = torch.from_numpy(validates(episodes, validation_share))
        return self.take(~held_out), self.take(held_out)

    @classmethod
    def join(cls, parts: Sequence[Windows]) -> Windows:
        """Return the windows of several pools as one, in their order."""
        return cls._build(
            lambda name: torch.cat([getattr(part, name) for part in parts], dim=-1),
            tuple(name for part in parts for name in part.ids),
        )

    @classmethod
    def _build(cls, tensor: Callable[[str], Tensor], ids: tuple[str, ...]) -> Windows:
        names = [field.name for field in fields(cls) if field.name != "ids"]
        return cls(**{name: tensor(name) for name in names}, ids=ids)


def windows_of(pool_path: Path) -> Windows:
    """Return a pool's windows; `UserError` when there is no finished pool to read.

    A pool of the paper gets the paper's number of windows, spread evenly over all possible ones.
    """
    windows = cut(FlightData.read(pool_path))
    count, every = COUNTS.get(pool_path.stem, len(windows)), len(windows)
    return windows if count >= every else windows.take(torch.arange(count) * every // count)


def every_history(pool_path: Path) -> Windows:
    """Return every window of 12 intervals of a pool, without a future; raises as `windows_of`."""
    return cut(FlightData.read(pool_path), 1, HISTORY)


def starts(steps: int, stride: int = STRIDE, length: int = COMMANDS) -> list[int]:
    """Return the first step of each window in an episode of `steps` control steps.

    They are spread evenly, at least `stride` apart, from the episode's start to its end.
    """
    room = steps - length
    if room < 0:
        return []
    gaps = room // stride
    return [room * i // gaps for i in range(gaps + 1)] if gaps else [room // 2]


def places(pool: FlightData, stride: int = STRIDE, length: int = COMMANDS) -> np.ndarray:
    """Return where the windows of a pool stand, [W, 3]: episode, number in it, first step."""
    rows = [
        (episode, i, first)
        for episode, steps in enumerate(pool.steps.tolist())
        for i, first in enumerate(starts(steps, stride, length))
    ]
    return np.array(rows, dtype=np.int64).reshape(-1, 3)


def cut(pool: FlightData, stride: int = STRIDE, length: int = COMMANDS) -> Windows:
    """Return the windows of so many commands of a pool in memory."""
    table = places(pool, stride, length)
    episode, first = table[:, 0].copy(), table[:, 2]
    rows = np.arange(length + 1)[:, None] + pool.first_row[episode] + first

    def signal(name: str) -> Tensor:
        at = rows[:-1] if name == "command" else rows
        return torch.from_numpy(np.stack([values[at] for values in pool.values[SIGNALS[name]]]))

    def tensor(name: str) -> Tensor:
        if name in pool.vehicles:
            return torch.from_numpy(np.take(pool.vehicles[name], episode, axis=-1)).float()
        values = signal(name)
        if name == "rotation":
            return values.view(3, 3, *values.shape[1:])
        return values[0] if name == "motor_thrust_n" else values

    return Windows._build(tensor, tuple(f"{pool.name}/{e:05d}/{i}" for e, i, _ in table.tolist()))


DeliveredInputs = Mapping[tuple[str, str], Tensor]
"""The calibration that taps delivered to windows, `[W]`, by channel and reader; it is held over
history and horizon."""


def readers_of(model: Predictor) -> frozenset[str]:
    """Return the names under which the interface lists the places where a model reads."""
    return frozenset(f"predictor.{place}" for place in model.reads)


def correct(model: Predictor, windows: Windows) -> DeliveredInputs:
    """Return the true calibration at every place at which a model reads it."""
    return {
        (channel, reader): value
        for channel, value in windows.calibration.items()
        for reader in readers_of(model)
    }


def predict(predictor: Predictor, windows: Windows, delivered: DeliveredInputs) -> Iterator[State]:
    """Yield the predicted states 13 to 32 of every window, batch `[W, 1]`.

    The true wind of the present is held over the horizon.
    """
    past = _taking(windows, delivered, slice(0, HISTORY))
    present = _taking(windows, delivered, HISTORY)

    def take(channel: str, place: str) -> Tensor:
        if channel != "history_code":
            return present(channel, place)
        code = predictor.encode(history(predictor.reads, past))
        assert code is not None
        return code

    inputs = predictor_inputs(predictor.reads, take)
    commands = windows.command[:, HISTORY:].movedim(1, 0)[..., None]
    return unroll(predictor, inputs, commands)


def _taking(windows: Windows, delivered: DeliveredInputs, k: int | slice) -> Take:
    def take(channel: str, place: str) -> Tensor:
        if channel in windows.calibration:
            return delivered[channel, f"predictor.{place}"]
        if channel == "physics":
            return windows.physics(HISTORY).reading()
        recorded = {
            "position": windows.position,
            "velocity": windows.velocity,
            "attitude": windows.rotation,
            "body_rate": windows.rate,
            "action": windows.command,
            "wind": windows.wind_mps,
        }
        return recorded[channel][..., k, :]

    return take
