"""A model small enough to fit in milliseconds."""

import os
import signal
import time
from pathlib import Path
from typing import Any

import torch
from faultpath_quadrotor.training.catalogue import ModelEntry
from faultpath_quadrotor.training.fitting import ModelTask
from torch import LongTensor, Tensor, nn
from torch.nn import functional

from faultpath.core.errors import UserError
from faultpath.core.streams import generator
from faultpath.learning.model_card import Schedule


def draw(purpose: str, seed: int, *shape: int) -> Tensor:
    return torch.from_numpy(generator(purpose, "toy", seed).standard_normal(shape)).float()


class Net(nn.Module):
    """Features first, batch last."""

    def __init__(self, seed: int) -> None:
        super().__init__()
        self.first = nn.Parameter(draw("toy/first", seed, 8, 3))
        self.last = nn.Parameter(draw("toy/last", seed, 1, 8))
        self.register_buffer("scale", torch.tensor([1.0, 2.0, 0.5]))

    def forward(self, x: Tensor) -> Tensor:
        return self.last @ torch.tanh(self.first @ (x * self.scale[:, None]))


class Toy(ModelTask):
    """Regression of a sum."""

    count, order_key, name = 150, "toy order", "toy"

    def __init__(self, seed: int = 0, **schedule: Any) -> None:
        self.seed = seed
        self.schedule = Schedule(**{"epochs": 4, "batch_size": 32} | schedule)
        self.magnitude = 0.0
        self.stop_at: tuple[int, int] | None = None
        """Epoch and minibatch at which Ctrl-C comes."""
        self.poisoned: int | None = None
        """Epoch from which the loss is not a number."""
        self.pause_s = 0.0
        self.weight = 1.0
        self.data_sha256 = "3fa9"
        self._epoch, self._batch = 0, 0

    def load(self) -> None:
        self._input = draw("toy/input", 0, 3, 200)
        self._target = self._input.sum(0, keepdim=True)

    def module(self) -> nn.Module:
        return Net(self.seed)

    def begin_epoch(self, epoch: int) -> None:
        self._epoch, self._batch = epoch, 0

    def loss(self, module: nn.Module, index: LongTensor) -> Tensor:
        if torch.is_grad_enabled() and (self._epoch, self._batch) == self.stop_at:
            raise KeyboardInterrupt
        time.sleep(self.pause_s)
        self._batch += 1
        error = functional.mse_loss(module(self._input[:, index]), self._target[:, index])
        poisoned = self.poisoned is not None and self._epoch >= self.poisoned
        return self.weight * error * (torch.nan if poisoned else 1.0)

    def validate(self, module: nn.Module) -> dict[str, float]:
        assert not module.training
        error = module(self._input[:, 150:]) - self._target[:, 150:]
        return {"error": error.detach().square().mean().sqrt().item()}

    def describe(self) -> dict[str, Any]:
        data = {"toy": self.data_sha256}
        return {"description": "a toy", "data_sha256": data, "magnitude": self.magnitude}


def make(name: str, seed: int, data: Path) -> ModelTask:
    """Make a task for the catalogue: `slow` is long, and slow while there is a file `data/gate`."""
    if name == "mistake":
        raise UserError("the toy has no data: make some.")
    if name == "bug":
        raise ZeroDivisionError("the toy is broken")
    if name == "dies":
        os.kill(os.getpid(), signal.SIGKILL)
    task = Toy(seed, epochs=30 if name == "slow" else 4)
    task.name = name
    task.pause_s = 0.02 if (data / "gate").exists() else 0.0
    return task


def entry(name: str, **more: Any) -> ModelEntry:
    return ModelEntry(name, make, (), f"{name} of the tests", **{"cost": 1.0, "seeds": (0,)} | more)
