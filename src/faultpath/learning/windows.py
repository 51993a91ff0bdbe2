"""Windows of readings for fitting a module, delivered by the taps of its interface."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b, sha256
from typing import Any

import numpy as np

from faultpath.core.arrays import Array, HostArray, namespace
from faultpath.core.errors import UserError
from faultpath.core.text import counted, listed, unknown
from faultpath.faults import Fault
from faultpath.interface import Interface, Provenance, module_of
from faultpath.learning.model_card import Data
from faultpath.learning.repair import Repair
from faultpath.loop import Port, Reading, TapCount, Taps

_SEED_STRIDE = 100_000
"""Distance between the seeds of the faults' random numbers for two adjacent seeds of a fit."""
VALIDATION = _SEED_STRIDE - 1
"""Epoch whose errors validation uses."""

Targets = HostArray | Mapping[str, HostArray]


@dataclass(frozen=True, eq=False)
class Windows:
    """Windows, or whole episodes, of one length: a module's readings in them, and its targets.

    Args:
        interface: Interface of the module's system; its taps deliver.
        reader: The module to fit, or its readers `module.place`, or those of several modules.
        readings: Values of the source by channel: `[N, T, ...]` step by step, or `[N, ...]` if they
            are constant in a window. Without steps all are `[N, ...]`.
        targets: Argument of the loss, `[N, ...]` or such by name; a reconstruction needs none.
        dt_s: Length of a step, s.
        ids: Name of each window, which addresses its random numbers.
        episodes: Episode of each window; the split into training and validation does not divide
            an episode. Default: every window is one.

    Raises:
        UserError: Arguments do not fit together.
    """

    interface: Interface
    reader: str | Sequence[str]
    readings: Mapping[str, HostArray]
    targets: Targets | None
    dt_s: float
    ids: Sequence[str] = ()
    episodes: Sequence[str] = ()

    def __post_init__(self) -> None:
        if not self.readings:
            raise UserError("windows: there are no readings; give them by channel")
        readings = {name: np.atleast_1d(value) for name, value in self.readings.items()}
        object.__setattr__(self, "readings", readings)
        n = len(next(iter(readings.values())))
        if not n:
            raise UserError("windows: there are none: give readings of one or more")
        ids = tuple(self.ids) or tuple(f"window/{i:06d}" for i in range(n))
        object.__setattr__(self, "ids", ids)
        object.__setattr__(self, "episodes", tuple(self.episodes) or ids)
        parts: dict[str, Any] = {f"readings of '{name}'": v for name, v in readings.items()}
        parts |= {
            f"targets '{name}'": value for name, value in targets_by_name(self.targets).items()
        }
        parts |= {"ids": ids, "episodes": self.episodes}
        for what, value in parts.items():
            if len(value) != n:
                raise UserError(
                    f"windows: {what} has {len(value)} rows for {n} windows: correct it"
                )
        if len(set(ids)) < n:
            raise UserError(
                "windows: two have the same id, and would get the same errors: rename one"
            )
        for name, value in readings.items():
            shape = self.shape(name)
            fits = (shape, shape if self.steps is None else (self.steps, *shape))
            if value.shape[1:] not in fits:
                expected = " or ".join(str([n, *sizes]) for sizes in dict.fromkeys(fits))
                raise UserError(
                    f"windows: readings of '{name}' have the shape {list(value.shape)}, and the "
                    f"interface says {expected}: correct one of the two"
                )
        missing = {port.channel for port in self.ports} - set(readings)
        if missing:
            raise UserError(
                f"windows: {listed(self.readers)} read {listed(missing)}, of which there are no "
                "readings: add them, or name fewer places as reader"
            )

    def __len__(self) -> int:
        return len(self.ids)

    @cached_property
    def readers(self) -> tuple[str, ...]:
        """Readers `module.place` of the fitted module."""
        names = (self.reader,) if isinstance(self.reader, str) else tuple(self.reader)
        known = dict.fromkeys(c for channel in self.interface.channels for c in channel.readers)
        for name in names:
            if not any(name in (reader, module_of(reader)) for reader in known):
                names_known = {*known, *map(module_of, known)}
                raise UserError(f"windows: {unknown('reader', name, names_known)}")
        return tuple(c for c in known if c in names or module_of(c) in names)

    @cached_property
    def ports(self) -> Mapping[Port, str]:
        """Ports of the fitted module, with their readers' full names."""
        ports: dict[Port, str] = {}
        for channel in self.interface.channels:
            for reader in channel.readers:
                if reader not in self.readers:
                    continue
                port = Port(channel.name, reader.partition(".")[2])
                if port in ports:
                    raise UserError(
                        f"windows: {ports[port]} and {reader} read '{port.channel}' at places of "
                        "one name: fit them apart"
                    )
                ports[port] = reader
        return ports

    def shape(self, channel: str) -> tuple[int, ...]:
        """Return the shape of one reading of a channel."""
        return self.interface.source(self.interface.channel(channel).sources[0]).shape

    @cached_property
    def steps(self) -> int | None:
        """Steps of a window; `None` if readings have none."""
        for name, value in self.readings.items():
            if value.ndim == len(self.shape(name)) + 2:
                return int(value.shape[1])
        return None

    def split(self, validation: float) -> tuple[HostArray, HostArray]:
        """Return the indices of the windows for training and for validation.

        The side of an episode depends on its name alone.
        """
        held_out = validates(self.episodes, validation)
        return np.flatnonzero(~held_out), np.flatnonzero(held_out)

    def learned(self, repairs: Iterable[Repair]) -> Targets:
        """Return the targets; for a reconstruction the correct readings of its channel."""
        channels = [repair.channel for repair in repairs if repair.channel is not None]
        if len(channels) > 1:
            raise UserError(f"fit: a module reconstructs one channel, not {listed(channels)}")
        if not channels:
            if self.targets is None:
                raise UserError(
                    "fit: the windows have no targets; only a reconstruction needs none"
                )
            return self.targets
        for port, reader in self.ports.items():
            if port.channel in channels:
                raise UserError(
                    f"fit: {reader} reads '{channels[0]}', which it is to reconstruct: leave "
                    "that place out of reader"
                )
        if channels[0] not in self.readings:
            raise UserError(
                f"fit: there are no readings of '{channels[0]}' to learn from: add them"
            )
        return self.readings[channels[0]]

    def digests(self, targets: Targets, training: HostArray) -> Data:
        """Return digests of the data, with these windows on the training side."""
        return Data(
            readings_sha256={
                name: array_sha256(self.readings[name]) for name in sorted(self.readings)
            },
            targets_sha256={
                name: array_sha256(value) for name, value in targets_by_name(targets).items()
            },
            ids_sha256=self.names_sha256(np.arange(len(self))),
            windows=len(self),
            steps=self.steps,
            dt_s=self.dt_s,
            training=len(training),
            training_sha256=self.names_sha256(training),
        )

    def names_sha256(self, index: HostArray) -> str:
        """Return a digest of some windows' names, in this order."""
        return sha256("\n".join(self.ids[int(i)] for i in index).encode()).hexdigest()


def validates(episodes: Sequence[str], share: float) -> HostArray:
    """Return which windows are for validation, by the names of their episodes."""
    draws: dict[str, float] = {}
    for name in dict.fromkeys(episodes):
        digest = blake2b(name.encode(), digest_size=8, person=b"validation").digest()
        draws[name] = int.from_bytes(digest, "little") / 2**64
    return np.array([draws[name] < share for name in episodes], dtype=bool)


def delivered(
    windows: Windows,
    faults: Iterable[Fault],
    readings: Mapping[str, Array],
    index: Sequence[int] | HostArray,
    seed: int,
    epoch: int,
) -> tuple[dict[Port, Array], tuple[TapCount, ...]]:
    """Return the deliveries at each port for some windows in an epoch, and the taps' counts.

    For the taps a window is a scene. Its random numbers depend on its name, the seed and the epoch,
    not on its minibatch. `readings` hold the rows `index` of the windows'. Arrays are
    `[n, T, ...]`, or `[n, ...]` where windows have no steps. Raises `NotDelivered` where a fault
    missed a reader that it names, and `UserError` where it begins after the last step.
    """
    steps, interface, faults = windows.steps, windows.interface, tuple(faults)
    for fault in faults:
        if fault.onset_step >= (steps or 1):
            raise UserError(
                f"windows: '{fault.describe()}' begins after their last step, and no window would "
                f"have it: they have {counted(steps or 1, 'step')}"
            )
    ids = tuple(windows.ids[i] for i in index)
    taps = window_taps(interface, faults, ids, windows.dt_s, seed, epoch, windows.readers)
    ports = windows.ports
    values: dict[Port, list[Array]] = {port: [] for port in ports}
    for step in range(steps or 1):
        for port, reader in ports.items():
            source = readings[port.channel]
            if source.ndim == len(windows.shape(port.channel)) + 2:
                source = source[:, step]
            reading = Reading(source, taps.bindings[port.channel], step)
            values[port].append(taps.deliver(port.channel, reader, reading, step))
    taps.verify(last_step=(steps or 1) - 1)
    stacked = {
        port: by_step[0] if steps is None else namespace(by_step[0]).stack(by_step, axis=1)
        for port, by_step in values.items()
    }
    return stacked, taps.delivery_log().counts()


def window_taps(
    interface: Interface,
    faults: Iterable[Fault],
    ids: tuple[str, ...],
    dt_s: float,
    seed: int,
    epoch: int,
    readers: Collection[str],
) -> Taps:
    """Return taps for windows as scenes, with other random numbers in each epoch of a fit."""
    return Taps(
        interface,
        faults,
        scenes=ids,
        dt_s=dt_s,
        seed=_SEED_STRIDE * seed + epoch,
        readers=readers,
        privileged={s.name for s in interface.sources if s.provenance is Provenance.PRIVILEGED},
    )


def array_sha256(array: HostArray) -> str:
    """Return a digest of an array's type, shape and bits."""
    head = f"{array.dtype.str}{array.shape}".encode()
    return sha256(head + np.ascontiguousarray(array).tobytes()).hexdigest()


def targets_by_name(targets: Targets | None) -> dict[str, HostArray]:
    """Return targets by name; a single one is called `target`."""
    if isinstance(targets, Mapping):
        return {name: np.asarray(value) for name, value in targets.items()}
    return {} if targets is None else {"target": np.asarray(targets)}
