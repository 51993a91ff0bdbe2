"""Fitting of the learned predictors (paper, Section IV-A)."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import torch
from torch import LongTensor, Tensor, nn
from typing_extensions import override

from faultpath.plugin.system import generator
from faultpath.plugin.training import Schedule
from faultpath_quadrotor import so3
from faultpath_quadrotor.choices import PREDICTORS
from faultpath_quadrotor.models import blank_predictor
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.predictors import (
    AnchoredPredictor,
    LatentNetwork,
    Predictor,
    UnanchoredNetwork,
    UnanchoredPredictor,
)
from faultpath_quadrotor.predictors.network import features
from faultpath_quadrotor.state import State
from faultpath_quadrotor.training.corruption import DCC_HALF_RANGE, corrupted, dcc
from faultpath_quadrotor.training.fitting import ModelTask
from faultpath_quadrotor.training.pool import pool_path, pools_sha256
from faultpath_quadrotor.training.windows import (
    HISTORY,
    HORIZON,
    Windows,
    correct,
    predict,
    readers_of,
    windows_of,
)

DCC = "+dcc"
BATCH_SIZE = 256  # paper, Section IV-A
PARTS = ("position", "velocity", "rotation", "rate")


_NOMINAL, _BOTH = ("nominal",), ("nominal", "wind")
RECIPES = {
    "wm-a": (_NOMINAL, 10),
    "wm-u": (_NOMINAL, 30),
    "wm-a-wind": (_BOTH, 10),
    "wm-a-nowind": (_BOTH, 10),
}
"""Pools and epochs (paper, Section IV-A)."""


class PredictorTask(ModelTask):
    """One predictor: the error of its own 20-step rollout, in units of how far states move.

    Each prediction is the input to the next step; recorded states are targets only. With `+dcc` in
    the name the calibration passes through the audit's faults on its way to the model; samples,
    targets, initial weights and the order of minibatches stay (paper, Equation 1).
    """

    def __init__(
        self, name: str, seed: int, data: Path, half_range: float = DCC_HALF_RANGE
    ) -> None:
        self.name = name
        self.seed = seed
        self.order_key = name.removesuffix(DCC)
        self._pools, epochs = RECIPES[self.order_key]
        self.schedule = Schedule(epochs=epochs, batch_size=BATCH_SIZE)
        self._data = data
        self._half_range = half_range
        self.platform = PLATFORM.weights_hash(name)

    def load(self) -> None:
        """See `ModelTask.load`; several pools contribute equally many windows."""
        pools = [windows_of(pool_path(self._data, name)).split() for name in self._pools]
        fewest = min(len(training) for training, _ in pools)
        training = Windows.join(
            [part.take(torch.arange(fewest) * len(part) // fewest) for part, _ in pools]
        )
        self._validation = Windows.join([validation for _, validation in pools])
        self._train, self.count = training, len(training)
        self._scales = scales(training)
        readers = readers_of(self._blank())
        faults = dcc(readers, self._half_range) if self.is_dcc else ()
        self._delivered = corrupted(faults, readers, training.ids, self.seed, training.calibration)

    @property
    def is_dcc(self) -> bool:
        """Whether the calibration is corrupted in training."""
        return self.name.endswith(DCC)

    @override
    def module(self) -> nn.Module:
        network = self._blank().network
        stream = generator("training/weights", self.order_key, self.seed)
        network.initialise(torch.Generator().manual_seed(int(stream.integers(2**62))))
        _measure(network, self._train)
        return network

    @override
    def loss(self, net: nn.Module, index: LongTensor) -> Tensor:
        batch = self._train.take(index)
        delivered = {tap: value[index] for tap, value in self._delivered.items()}
        predicted = list(predict(self._predictor(net), batch, delivered))
        return error(predicted, batch, self._scales)

    def validate(self, net: nn.Module) -> Mapping[str, float]:
        """Return the median 20-step position error under correct calibration, and the loss."""
        predictor = self._predictor(net)
        windows = self._validation
        predicted = list(predict(predictor, windows, correct(predictor, windows)))
        missed = (predicted[-1].position[..., 0] - windows.position[:, -1]).norm(dim=0)
        return {
            "position_error_20_m": float(missed.median()),
            "loss": float(error(predicted, windows, self._scales)),
        }

    @override
    def describe(self) -> Mapping[str, Any]:
        return {
            "description": PREDICTORS[self.name],
            "data_sha256": pools_sha256(self._data, self._pools),
            "history": HISTORY,
            "horizon": HORIZON,
            "calibration_half_range": self._half_range if self.is_dcc else 0.0,
            "validation_windows": len(self._validation),
            "scales": {name: float(value) for name, value in self._scales.items()},
        }

    def _blank(self) -> AnchoredPredictor | UnanchoredPredictor:
        predictor = blank_predictor(self.order_key)
        assert isinstance(predictor, AnchoredPredictor | UnanchoredPredictor)
        return predictor

    def _predictor(self, network: nn.Module) -> Predictor:
        predictor: Any = self._blank()
        predictor.network = network
        return predictor


def scales(windows: Windows) -> dict[str, Tensor]:
    """Return how far each part of the state moves over the horizon: its root mean square change."""
    return {
        name: (ahead - ahead[..., :1, :]).square().mean().sqrt()
        for name in PARTS
        for ahead in [getattr(windows, name)[..., HISTORY:, :]]
    }


def error(predicted: Sequence[State], windows: Windows, scale: Mapping[str, Tensor]) -> Tensor:
    """Return the mean squared error of rollouts, in units of `scale`, the parts weighing alike."""
    parts = []
    for name in PARTS:
        ahead = torch.stack([getattr(state, name)[..., 0] for state in predicted], dim=-2)
        recorded = getattr(windows, name)[..., HISTORY + 1 :, :]
        parts.append((ahead - recorded).square().mean() / scale[name] ** 2)
    return torch.stack(parts).mean()


def _measure(network: LatentNetwork, windows: Windows) -> None:
    """Store the training windows' statistics, under true calibration, in the network."""
    state = windows.state(HISTORY)
    known = (windows.mass_kg, windows.thrust_scale) if network.conditioned else None
    motion = (state.velocity, state.rotation, state.rate)
    raw = features(*motion, windows.command[:, HISTORY], windows.mass_kg, known)
    network.feature_mean.copy_(raw.mean(1, keepdim=True))
    network.feature_std.copy_(raw.std(1, keepdim=True))
    if isinstance(network, UnanchoredNetwork):
        ahead = windows.state(HISTORY + 1)
        moved = [
            getattr(ahead, name) - getattr(state, name) for name in ("position", "velocity", "rate")
        ]
        turned = so3.log(so3.compose(state.rotation.transpose(0, 1), ahead.rotation))
        network.increment_std.copy_(torch.cat([*moved, turned]).std(1, keepdim=True))
