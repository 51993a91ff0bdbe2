"""Fitting the learned wind reconstruction: its data, its corruption and its loss."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from torch import LongTensor, Tensor, nn
from torch.nn import functional
from typing_extensions import override

from faultpath.plugin.system import generator
from faultpath.plugin.training import Schedule
from faultpath_quadrotor.choices import RECONSTRUCTIONS
from faultpath_quadrotor.models import blank_reconstruction
from faultpath_quadrotor.platform import PLATFORM, TRAJECTORY
from faultpath_quadrotor.reconstruction import RecurrentReconstruction, WindNetwork
from faultpath_quadrotor.training import TRAJECTORY_POOL
from faultpath_quadrotor.training.corruption import (
    DCC_HALF_RANGE,
    STATE_STD,
    corrupted,
    dcc,
    state_noise,
)
from faultpath_quadrotor.training.fitting import ModelTask
from faultpath_quadrotor.training.pool import pool_path, pools_sha256
from faultpath_quadrotor.training.windows import HISTORY, Windows, every_history, windows_of

HEAD, PAST = "reconstruction.head", "reconstruction.history"


@dataclass(frozen=True)
class Model:
    """Settings in which the models differ."""

    half_range: float | None = None
    """Half range of the noise on the head's calibration; `None`: there is no noise."""
    moves: bool = False
    """Whether there is noise on the motion in the history."""


MODELS: Mapping[str, Model] = {
    "gru": Model(),
    "gru+dcc": Model(half_range=DCC_HALF_RANGE),
    "gru+state": Model(moves=True),
    "gru-withheld": Model(),
    "gru-trajectory": Model(),
}
"""The reference module, its repair, the control without calibration, and the one that learns from
closed-loop flights, which has no calibration input (paper, Section V-A and V-B)."""


@dataclass(frozen=True)
class _Samples:
    """Windows as the network takes them, standardised once; N windows."""

    intervals: Tensor  # [22, 12, N]
    latest: Tensor  # [18, N]
    calibration: Tensor  # m and T as they are, [2, N]
    wind_mps: Tensor  # [3, N]

    @classmethod
    def of(cls, windows: Windows, network: WindNetwork, errors: Tensor | float = 0.0) -> _Samples:
        states, commands = _history(windows)
        intervals, latest = network.inputs(states + errors, commands)
        return cls(intervals, latest, _calibration(windows), windows.wind_mps[:, HISTORY])


class ReconstructionTask(ModelTask):
    """One reconstruction: mean squared error of the wind vector (paper, appendix).

    A window's history is its commands 0..11 with the states 1..12 that they led to; the target is
    the wind at state 12.
    """

    def __init__(self, name: str, seed: int, data_folder: Path) -> None:
        self.name = name
        self.seed = seed
        self.platform = PLATFORM.weights_hash(name)
        self.schedule = Schedule(epochs=40, batch_size=256, optimiser="adam")  # paper, appendix
        self._model = MODELS[name]
        self._pool = TRAJECTORY_POOL if name == TRAJECTORY else "wind"
        self._data = data_folder
        self.order_key = name.partition("+")[0]
        blank = blank_reconstruction(name)
        assert isinstance(blank, RecurrentReconstruction)
        self._scaled = blank.network

    @override
    def load(self) -> None:
        windows = every_history if self._pool == TRAJECTORY_POOL else windows_of
        self.use(*windows(pool_path(self._data, self._pool)).split())

    def use(self, training: Windows, validation: Windows) -> None:
        """Take windows from memory, and the scales of inputs from the training ones."""
        self._scaled.measure(*_history(training), _calibration(training))
        errors = self._errors(training) if self._model.moves else 0.0
        self._training = _Samples.of(training, self._scaled, errors)
        self.count = len(training.ids)
        self._validation = _Samples.of(validation, self._scaled)
        self._supplied = self._calibration(training.ids) if self._scaled.calibrated else None

    @override
    def module(self) -> nn.Module:
        network = copy.deepcopy(self._scaled)
        stream = generator("initial weights", self.order_key, self.seed)
        network.initialise(torch.Generator().manual_seed(int(stream.integers(2**63))))
        return network

    @override
    def loss(self, net: nn.Module, index: LongTensor) -> Tensor:
        samples = self._training
        estimate = net(
            samples.intervals.index_select(2, index),
            samples.latest.index_select(1, index),
            None if self._supplied is None else self._supplied.index_select(1, index),
        )
        return functional.mse_loss(estimate, samples.wind_mps.index_select(1, index))

    @override
    def validate(self, net: nn.Module) -> Mapping[str, float]:
        """Return the root mean square length of the wind's error, m/s, under the calibration."""
        scales, samples = self._scaled, self._validation
        known = scales.calibration(samples.calibration) if scales.calibrated else None
        error = net(samples.intervals, samples.latest, known) - samples.wind_mps
        return {"wind_rmse_mps": float(error.square().sum(0).mean().sqrt())}

    @override
    def describe(self) -> Mapping[str, Any]:
        return {
            "description": RECONSTRUCTIONS[self.name],
            "data_sha256": pools_sha256(self._data, [self._pool]),
            "calibration_inputs": self._scaled.calibrated,
            "calibration_noise_half_range": self._model.half_range,
            **({"motion_noise_std": STATE_STD} if self._model.moves else {}),
        }

    def _errors(self, windows: Windows) -> Tensor:
        """Return the noise on the state of every interval of a window, `[18, 1, N]`."""
        latest = (
            part[..., HISTORY, :].movedim(-1, 0)
            for part in (windows.position, windows.velocity, windows.rotation, windows.rate)
        )
        readings = dict(zip(STATE_STD, latest, strict=True))
        noisy = corrupted(state_noise(PAST), [PAST], windows.ids, self.seed, readings)
        errors = [(noisy[name, PAST] - value).flatten(1) for name, value in readings.items()]
        return torch.cat(errors, 1).T[:, None]

    def _calibration(self, windows: tuple[str, ...]) -> Tensor:
        """Return the calibration that the head gets, standardised, `[2, N]`."""
        half_range = self._model.half_range
        faults = () if half_range is None else dcc([HEAD], half_range)
        mass, scale = self._training.calibration
        readings = {"mass": mass, "thrust_scale": scale}
        delivered = corrupted(faults, [HEAD], windows, self.seed, readings)
        supplied = torch.stack([delivered["mass", HEAD], delivered["thrust_scale", HEAD]])
        return self._scaled.calibration(supplied)


def _history(windows: Windows) -> tuple[Tensor, Tensor]:
    parts = (windows.position, windows.velocity, windows.rotation.flatten(0, 1), windows.rate)
    return torch.cat(parts)[:, 1 : HISTORY + 1], windows.command[:, :HISTORY]


def _calibration(windows: Windows) -> Tensor:
    return torch.stack((windows.mass_kg, windows.thrust_scale))
