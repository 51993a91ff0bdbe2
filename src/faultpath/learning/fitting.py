"""Fits a user's torch module to windows that come through the taps.

Laws. Initial weights and the order of minibatches depend on module and seed, never on the repair;
an error of size zero changes no bit; torch's random state in the process is the same afterwards.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from typing_extensions import override

from faultpath.core.errors import UserError
from faultpath.core.files.atomic import make_folder
from faultpath.core.streams import key
from faultpath.faults import Fault, resolve
from faultpath.learning.loop import FitTask, History, minibatches, run
from faultpath.learning.model_card import (
    Architecture,
    FitRecord,
    Machine,
    Schedule,
    fill,
    parameter_count,
    save,
    weights_sha256,
)
from faultpath.learning.repair import Repair, parsed_by_cause, withheld_faults
from faultpath.learning.windows import VALIDATION, Windows, delivered, targets_by_name
from faultpath.loop import TapCount, added

if TYPE_CHECKING:
    from torch import LongTensor, Tensor, nn

LossFunction = Callable[[Any, Any], "Tensor"]
"""Mean loss of a minibatch, a scalar, from the module's output and the targets."""


@dataclass(frozen=True)
class Fit:
    """A fitted module, and the record of the fit."""

    module: nn.Module
    """In evaluation mode."""
    record: FitRecord
    path: Path | None = None
    """Path of its weights, with the record beside them, if a folder was given."""


def mean_squared_error(output: Tensor, target: Tensor) -> Tensor:
    """Return the mean squared error; `UserError` for different shapes, which torch would
    broadcast."""
    from torch.nn import functional

    if output.shape != target.shape:
        raise UserError(
            f"mean_squared_error: the module returns the shape {list(output.shape)} and the target "
            f"has {list(target.shape)}: correct one of the two"
        )
    return functional.mse_loss(output, target)


def fit(
    module: nn.Module | Callable[[], nn.Module],
    data: Windows,
    loss: LossFunction = mean_squared_error,
    *,
    repair: Repair | Iterable[Repair] = (),
    seed: int = 0,
    schedule: Schedule | None = None,
    validation: float = 0.1,
    name: str | None = None,
    folder: Path | str | None = None,
) -> Fit:
    """Fit a module, as a baseline or with a repair, and return it with its record.

    The module's `forward` takes one mapping, as a module of the loop does: the deliveries of the
    channel `gain` at the place `model` are `inputs["gain", "model"]`, `[n, T, ...]`, or `[n, ...]`
    where windows have no steps.

    Args:
        module: The module to fit, which is copied with its weights as the initial ones; or a
            function that makes it, called with torch's random numbers at the seed.
        data: Windows and targets.
        loss: Function of the module's output and the targets, tensors as `Windows` names them.
        repair: One repair or several; none makes a baseline.
        seed: Seed of initial weights, minibatch order, torch's random numbers and errors.
        schedule: Default: `Schedule()`.
        validation: Share of the episodes that is held out for validation.
        name: Name of the files; default the module's class and the repair's kind.
        folder: Folder for `<name>-<seed>.safetensors` and its record `.json`, each whole or absent.

    Raises:
        UserError: Arguments do not fit together, or the loss is no longer finite.
    """
    import torch

    if seed < 0:
        raise UserError(f"fit: the seed {seed} is negative: seeds start at 0")
    if not 0 <= validation <= 1:
        raise UserError(f"fit: validation={validation} is no share, a number from 0 to 1")
    repairs = (repair,) if isinstance(repair, Repair) else tuple(repair)
    repairs = tuple(part.against(data.interface, data.dt_s, data.readers) for part in repairs)
    with torch.random.fork_rng():
        # The module's own code draws from torch's global state (initialisation, dropout), which is
        # the fit's in this block and the caller's again afterwards.
        torch_seed = key("repairs/torch", "fit", seed) % 2**63
        torch.manual_seed(torch_seed)
        net = copy.deepcopy(module) if isinstance(module, torch.nn.Module) else module()
        if not isinstance(net, torch.nn.Module):
            raise UserError(
                f"fit: {_name_of(module)} returned a {_name_of(net)}, which is no torch module"
            )
        if not parameter_count(net):
            raise UserError(f"fit: {_name_of(net)} has no parameters to fit")
        torch.manual_seed(torch_seed)  # the same state whether or not the module was made here
        kinds = (part.kind.replace("_", "-") for part in repairs)
        task = _WindowTask(net, data, loss, repairs, seed, schedule or Schedule(), validation)
        task.name = name or "+".join((type(net).__name__.lower(), *kinds))
        if not task.count:
            raise UserError("fit: no window is left for training: give more, or validation=0")
        task.initial_sha256 = weights_sha256(net)
        task.first_loss = task.mean_loss(net, task.training[minibatches(task, 0)[0].numpy()], ())
        history = run(task, net)
    record = task.record(net, history)
    path = None
    if folder is not None:
        make_folder(Path(folder))
        path = save(net, record, Path(folder))
    return Fit(net.eval(), record, path)


def evaluate(
    fitted: Fit,
    data: Windows,
    loss: LossFunction = mean_squared_error,
    faults: Iterable[Fault | str] = (),
) -> float:
    """Return the mean loss of a fitted module over all windows, under faults as in an audit.

    Channels withheld in the fit stay withheld. Raises `UserError` as `fit`.
    """
    repairs = fitted.record.repairs
    resolved = [
        fault
        for parts in parsed_by_cause(
            (*faults, *withheld_faults(repairs)), data.interface, data.dt_s
        )
        for fault in resolve(parts, data.interface, data.readers)
    ]
    task = _WindowTask(
        fitted.module, data, loss, repairs, fitted.record.seed, Schedule(), validation=0.0
    )
    return task.mean_loss(fitted.module, np.arange(len(data)), resolved)


def load(module: nn.Module, path: Path | str) -> Fit:
    """Return a fit with the weights of its files; `UserError` where they do not fit."""
    record = fill(module, Path(path), FitRecord)
    return Fit(module.eval(), record, Path(path))


class _WindowTask(FitTask):
    """Fit of windows, delivered through the taps for each minibatch."""

    order_key = "repairs"
    initial_sha256: str
    first_loss: float

    def __init__(
        self,
        net: nn.Module,
        data: Windows,
        loss: LossFunction,
        repairs: tuple[Repair, ...],
        seed: int,
        schedule: Schedule,
        validation: float,
    ) -> None:
        import torch

        def tensor(array: np.ndarray) -> Tensor:
            return torch.from_numpy(np.require(array, requirements=["C", "W"])).to(self.device)

        self.repairs, self.seed, self.schedule = repairs, seed, schedule
        parameter = next(net.parameters(), None)
        self.device = torch.device("cpu") if parameter is None else parameter.device
        self.host_targets = data.learned(repairs)
        self.training, self._held_out = data.split(validation)
        self.count = len(self.training)
        self.order: list[str] = []
        """Digest of the order of the windows in each epoch."""
        self.taps: tuple[TapCount, ...] = ()
        self._data, self._loss, self._epoch = data, loss, 0
        self._faults: list[Any] = [fault for repair in repairs for fault in repair.faults]
        self._withheld = withheld_faults(repairs)
        read = {port.channel for port in data.ports}
        self._readings = {name: tensor(v) for name, v in data.readings.items() if name in read}
        self._targets = {name: tensor(v) for name, v in targets_by_name(self.host_targets).items()}

    @override
    def begin_epoch(self, epoch: int) -> None:
        self._epoch = epoch
        order = np.concatenate([part.numpy() for part in minibatches(self, epoch)])
        self.order.append(self._data.names_sha256(self.training[order])[:16])

    @override
    def loss(self, net: nn.Module, index: LongTensor) -> Tensor:
        value, counts = self._loss_of(net, self.training[index.numpy()], self._faults, self._epoch)
        self.taps = added((*self.taps, *counts))
        return value

    @override
    def validate(self, net: nn.Module) -> Mapping[str, float]:
        if not len(self._held_out):
            return {}
        cases = {"correct": self._withheld, "perturbed": self._faults}
        return {name: self.mean_loss(net, self._held_out, faults) for name, faults in cases.items()}

    def record(self, net: nn.Module, history: History) -> FitRecord:
        """Return the record of a finished fit."""
        return FitRecord(
            name=self.name,
            seed=self.seed,
            repairs=self.repairs,
            reads=tuple(f"{port.channel} -> {reader}" for port, reader in self._data.ports.items()),
            architecture=Architecture.of(net),
            parameters=parameter_count(net),
            data=self._data.digests(self.host_targets, self.training),
            loss=_name_of(self._loss),
            schedule=self.schedule,
            initial_sha256=self.initial_sha256,
            first_loss=self.first_loss,
            order_sha256=tuple(self.order),
            training_loss=history.training_loss,
            validation=tuple(metrics for metrics in history.validation if metrics),
            taps=self.taps,
            weights_sha256=weights_sha256(net),
            machine=Machine.here(self.device.type),
            duration_s=round(history.duration_s, 3),
        )

    def mean_loss(self, net: nn.Module, index: np.ndarray, faults: Iterable[Any]) -> float:
        """Return the mean loss of some windows, without gradients and in evaluation mode."""
        import torch

        faults, total, size = tuple(faults), 0.0, self.schedule.batch_size
        net.eval()
        with torch.no_grad():
            for part in np.split(index, range(size, len(index), size)):
                total += self._loss_of(net, part, faults, VALIDATION)[0].item() * len(part)
        return total / len(index)

    def _loss_of(
        self, net: nn.Module, part: np.ndarray, faults: Iterable[Any], epoch: int
    ) -> tuple[Tensor, tuple[TapCount, ...]]:
        import torch

        rows = torch.from_numpy(part).to(self.device)
        readings = {name: value[rows] for name, value in self._readings.items()}
        inputs, counts = delivered(self._data, faults, readings, part, self.seed, epoch)
        targets: Any = {name: value[rows] for name, value in self._targets.items()}
        if not isinstance(self.host_targets, Mapping):
            targets = targets["target"]
        loss = self._loss(net(inputs), targets)
        if not isinstance(loss, torch.Tensor) or loss.ndim:
            what = f"of shape {list(loss.shape)}" if hasattr(loss, "shape") else _name_of(loss)
            raise UserError(f"fit: the loss must be a tensor of one number, not {what}")
        return loss, counts


def _name_of(thing: Any) -> str:
    named = thing if hasattr(thing, "__qualname__") else type(thing)
    return named.__qualname__.replace("<locals>.", "")
