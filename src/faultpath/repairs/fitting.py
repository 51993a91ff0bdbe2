"""Fit a torch module of the user's to windows that come through the taps.

Laws. First weights and the order of minibatches depend on module and seed, never on the repair; an
error of size zero changes no bit; the process keeps the random numbers of torch that it had.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from faultpath.errors import UserError
from faultpath.faults import AnyFault
from faultpath.repairs.code import code_sha256, name_of
from faultpath.repairs.network import adam, fresh
from faultpath.repairs.record import FitRecord, Loss, Schedule
from faultpath.repairs.repair import Repair, kept, understood
from faultpath.repairs.weights import architecture, fill, machine, save, weights_sha256
from faultpath.repairs.windows import VALIDATION, Windows, delivered, named
from faultpath.streams import generator, key
from faultpath.taps import TapCount, added

if TYPE_CHECKING:
    from torch import Tensor, nn

LossFunction = Callable[[Any, Any], "Tensor"]
"""Mean loss of a minibatch, a scalar, from the module's output and the targets."""


@dataclass(frozen=True)
class Fit:
    """A fitted module, and the record of the fit."""

    module: nn.Module
    """In evaluation mode."""
    record: FitRecord
    path: Path | None = None
    """Its weights, with the record beside them, where a folder was given."""


def mean_squared_error(output: Tensor, target: Tensor) -> Tensor:
    """Return the mean squared error; `UserError` where shapes differ, which torch would stretch."""
    from torch.nn import functional

    if output.shape != target.shape:
        raise UserError(
            f"mean_squared_error: the module returns the shape {list(output.shape)} and the target "
            f"has {list(target.shape)}: mend one of the two"
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

    The module's `forward` takes one mapping, as a module of the loop does: what the tap delivers
    of the channel `gain` at the place `model` is `inputs["gain", "model"]`, `[n, T, ...]`, or
    `[n, ...]` where windows have no steps.

    Args:
        module: What is fitted; it is copied, and its weights are the initial ones. Or a function
            that makes it, called with torch's random numbers at the seed.
        data: Windows and targets.
        loss: Of the module's output and the targets, which are tensors as `Windows` names them.
        repair: One repair or several; none makes a baseline.
        seed: Of initial weights, minibatch order, torch's random numbers and errors.
        schedule: Default: `Schedule()`.
        validation: Share of the episodes that are kept for validation.
        name: Of the files; default the module's class and the repair's kind.
        folder: Gets `<name>-<seed>.safetensors` and its record `.json`, each whole or absent.

    Raises:
        UserError: Something does not fit together, or the loss left the finite numbers.
    """
    import torch

    schedule = schedule or Schedule()
    if seed < 0:
        raise UserError(f"fit: the seed {seed} is negative: seeds start at 0")
    with torch.random.fork_rng():
        # The module's own code draws from torch's global state (initialisation, dropout): it is the
        # fit's own in here, and the caller's again behind.
        drawn = key("repairs/torch", "fit", seed) % 2**63
        torch.manual_seed(drawn)
        net = fresh(module)
        torch.manual_seed(drawn)  # also where the module was not made here
        work = _Work(net, data, loss, _several(repair, data), seed, schedule, validation)
        work.run()
    record = work.record(name)
    if folder is None:
        return Fit(net.eval(), record)
    return Fit(net.eval(), record, save(net, record, Path(folder)))


def evaluate(
    fitted: Fit,
    data: Windows,
    loss: LossFunction = mean_squared_error,
    faults: Iterable[AnyFault | str] = (),
) -> float:
    """Return the mean loss of a fitted module over all windows, under faults as an audit has them.

    What it was fitted without stays withheld. Raises `UserError` as `fit`.
    """
    repairs = fitted.record.repairs
    struck = understood((*faults, *kept(repairs)), data.interface, data.dt_s)
    work = _Work(fitted.module, data, loss, repairs, fitted.record.seed, Schedule(), 0.0)
    return work.mean_loss(np.arange(len(data)), struck)


def load(module: nn.Module, path: Path | str) -> Fit:
    """Return a fit from its files, filled in; `UserError` where they do not fit."""
    record = fill(module, Path(path))
    return Fit(module.eval(), record, Path(path))


@dataclass
class _Work:
    """One fit under way."""

    net: nn.Module
    data: Windows
    loss: LossFunction
    repairs: tuple[Repair, ...]
    seed: int
    schedule: Schedule
    share: float
    order: list[str] = field(default_factory=list)
    curve: list[float] = field(default_factory=list)
    validation: list[dict[str, float]] = field(default_factory=list)
    taps: tuple[TapCount, ...] = ()

    def __post_init__(self) -> None:
        import torch

        def tensor(array: np.ndarray) -> Tensor:
            return torch.from_numpy(np.ascontiguousarray(array)).to(self.device)

        parameter = next(self.net.parameters(), None)
        self.device = torch.device("cpu") if parameter is None else parameter.device
        self.faults: list[Any] = [fault for each in self.repairs for fault in each.faults]
        self.kept = kept(self.repairs)
        self.host_targets = self.data.learned(self.repairs)
        self.readings = {name: tensor(v) for name, v in self.data.readings.items()}
        self.targets = {name: tensor(v) for name, v in named(self.host_targets).items()}
        self.training, self.held_out = self.data.split(self.share)
        if not len(self.training):
            raise UserError("fit: no window is left for training: give more, or validation=0")
        self.initial = weights_sha256(self.net)
        self.started = time.monotonic()

    def run(self) -> None:
        """Fit all epochs."""
        import torch

        optimiser = adam(self.net, self.schedule)
        self.initial_loss = self.mean_loss(self._permuted(0)[: self.schedule.batch_size], ())
        for epoch in range(self.schedule.epochs):
            order = self._permuted(epoch)
            self.order.append(self.data.names_sha256(order)[:16])
            self.curve.append(self._epoch(epoch, order, optimiser))
            if len(self.held_out):
                faults = {"correct": self.kept, "perturbed": self.faults}
                found = {k: self.mean_loss(self.held_out, each) for k, each in faults.items()}
                self.validation.append(found)
            if not all(torch.isfinite(v).all() for v in self.net.parameters()):
                raise self._diverged(epoch, "weights")
        self.seconds = time.monotonic() - self.started

    def mean_loss(self, index: np.ndarray, faults: Iterable[Any]) -> float:
        """Return the mean loss of some windows, without gradients and in evaluation mode."""
        import torch

        faults, total = tuple(faults), 0.0
        self.net.eval()
        with torch.no_grad():
            for part in _cut(index, self.schedule):
                total += self._loss(part, faults, VALIDATION)[0].item() * len(part)
        return total / len(index)

    def _epoch(self, epoch: int, order: np.ndarray, optimiser: Any) -> float:
        """Fit one epoch and return the mean loss of its windows."""
        from torch import nn

        total = 0.0
        self.net.train()
        for part in _cut(order, self.schedule):
            optimiser.zero_grad(set_to_none=True)
            loss, counts = self._loss(part, self.faults, epoch)
            value = loss.item()
            if not math.isfinite(value):
                raise self._diverged(epoch, "loss")
            loss.backward()
            if self.schedule.clip_norm is not None:
                nn.utils.clip_grad_norm_(self.net.parameters(), self.schedule.clip_norm)
            optimiser.step()
            self.taps = added((*self.taps, *counts))
            total += value * len(part)
        return total / len(order)

    def _loss(
        self, part: np.ndarray, faults: Iterable[Any], epoch: int
    ) -> tuple[Tensor, tuple[TapCount, ...]]:
        import torch

        rows = torch.from_numpy(part).to(self.device)
        read = {port.channel for port in self.data.ports}
        readings = {name: value[rows] for name, value in self.readings.items() if name in read}
        inputs, counts = delivered(self.data, faults, readings, part, self.seed, epoch)
        targets: Any = {name: value[rows] for name, value in self.targets.items()}
        if not isinstance(self.host_targets, Mapping):
            targets = targets["target"]
        loss = self.loss(self.net(inputs), targets)
        if not isinstance(loss, torch.Tensor) or loss.ndim:
            what = f"of shape {list(loss.shape)}" if hasattr(loss, "shape") else name_of(loss)
            raise UserError(f"fit: the loss must be a tensor of one number, not {what}")
        return loss, counts

    def _permuted(self, epoch: int) -> np.ndarray:
        return generator("repairs", "minibatches", self.seed, epoch).permutation(self.training)

    def _diverged(self, epoch: int, what: str) -> UserError:
        return UserError(
            f"fit: the {what} left the finite numbers in epoch {epoch + 1} of "
            f"{self.schedule.epochs}: lower the learning rate or clip the gradient"
        )

    def record(self, name: str | None) -> FitRecord:
        """Return what the fit says of itself."""
        kinds = (each.kind.replace("_", "-") for each in self.repairs)
        return FitRecord(
            name=name or "+".join((type(self.net).__name__.lower(), *kinds)),
            seed=self.seed,
            repairs=self.repairs,
            reads=tuple(
                f"{port.channel} -> {consumer}" for port, consumer in self.data.ports.items()
            ),
            architecture=architecture(self.net),
            parameters=sum(p.numel() for p in self.net.parameters() if p.requires_grad),
            data=self.data.digested(self.host_targets, self.training),
            loss=Loss(name=name_of(self.loss), code_sha256=code_sha256(self.loss)),
            schedule=self.schedule,
            initial_sha256=self.initial,
            initial_loss=self.initial_loss,
            order_sha256=tuple(self.order),
            training_loss=tuple(self.curve),
            validation=tuple(self.validation),
            taps=self.taps,
            weights_sha256=weights_sha256(self.net),
            machine=machine(self.device.type),
            duration_s=round(self.seconds, 3),
        )


def _cut(index: np.ndarray, schedule: Schedule) -> list[np.ndarray]:
    return np.split(index, range(schedule.batch_size, len(index), schedule.batch_size))


def _several(repair: Repair | Iterable[Repair], data: Windows) -> tuple[Repair, ...]:
    given = (repair,) if isinstance(repair, Repair) else tuple(repair)
    return tuple(each.against(data.interface, data.dt_s, data.consumers) for each in given)
