"""Repaired modules in a loop, which read the same channels as in their fit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from typing_extensions import override

from faultpath.core.arrays import HostArray, is_array, match_device, namespace, to_numpy
from faultpath.core.errors import UserError
from faultpath.faults import ALL, Erase, Fault
from faultpath.interface import Interface
from faultpath.learning.repair import Repair
from faultpath.loop import Batch, Inputs, Memory, Module, Outputs, Port

if TYPE_CHECKING:
    from torch import nn


class Learned(Module):
    """A fitted torch module in the loop: its output at each step, from the last steps' readings.

    At each step `forward` gets inputs as in the fit, `inputs["gain", "model"]` of `[1, T, ...]`,
    float32, the present last; before step T the first step fills in. Scenes are computed one by
    one, because torch may round a scene differently in another batch.

    Args:
        name: Name under which the interface lists its places.
        net: The fitted module; it returns `[n, ...]`.
        writes: Source that it writes.
        reads: Ports of this step.
        reads_past: Ports of the step before.
        steps: T; `None` where the fit's windows had no steps.
    """

    def __init__(
        self,
        name: str,
        net: nn.Module,
        writes: str,
        reads: Iterable[Port],
        reads_past: Iterable[Port] = (),
        steps: int | None = None,
    ) -> None:
        self.name, self.writes = name, (writes,)
        self.reads, self.reads_past = frozenset(reads), frozenset(reads_past)
        self._net, self._steps = net, steps

    @override
    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        import torch

        present = {port: to_numpy(inputs[port]).astype(np.float32) for port in inputs}
        length = self._steps or 1
        past = (*(memory or (present,) * (length - 1)), present)
        history = past[1 - length :] if length > 1 else ()
        windows = {port: np.stack([step[port] for step in past], axis=1) for port in present}
        if self._steps is None:
            windows = {port: value[:, 0] for port, value in windows.items()}
        tensors = {port: torch.from_numpy(value) for port, value in windows.items()}
        scenes = range(len(next(iter(present.values()))))
        with torch.no_grad():
            rows = [self._net({p: v[i : i + 1] for p, v in tensors.items()})[0] for i in scenes]
        return {self.writes[0]: np.stack([row.numpy() for row in rows]).astype(float)}, history


def withheld(module: Module, repair: Repair, interface: Interface) -> Module:
    """Return a module that gets a withheld channel's neutral value without reading the channel.

    It has no tap there, so no fault on the channel reaches it: this is the variant to audit. If the
    repair has no value, the erasure default of `interface` is used. Raises `UserError` where the
    repair withholds nothing that the module reads.
    """
    values: dict[Port, HostArray] = {}
    for fault in repair.faults:
        if not isinstance(fault, Fault) or not isinstance(fault.intervention, Erase):
            raise UserError(f"withheld: {repair.words} is no withholding")
        channel, value = interface.channel(fault.channel), fault.intervention.default
        shape = interface.source(channel.sources[0]).shape
        neutral = np.broadcast_to(channel.erasure_default if value is None else value, shape)
        for port in module.ports:
            names = {ALL, module.name, module.reader(port)}
            if port.channel == fault.channel and names & set(fault.readers):
                values[port] = neutral
    if not values:
        raise UserError(
            f"withheld: module '{module.name}' reads nothing of what {repair.words} names"
        )
    return _Withheld(module, values)


class _Withheld(Module):
    """Wraps a module and supplies some of its ports with constants."""

    def __init__(self, inner: Module, values: Mapping[Port, HostArray]) -> None:
        self.name, self.writes, self.truths = inner.name, inner.writes, inner.truths
        self.reads, self.reads_past = inner.reads - set(values), inner.reads_past - set(values)
        self.at_read = inner.at_read - set(values)
        self._inner, self._values = inner, values

    @override
    def begin(self, batch: Batch) -> Memory:
        return len(batch.scenes), self._inner.begin(batch)

    @override
    def before(self, batch: Batch) -> Outputs:
        return self._inner.before(batch)

    @override
    def noise_hashes(self, batch: Batch) -> Sequence[str] | None:
        return self._inner.noise_hashes(batch)

    @override
    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        scenes, past = memory
        readings = {port: inputs[port] for port in inputs}
        truths = {name: inputs.truth(name) for name in self.truths}
        sample = next((value for value in readings.values() if is_array(value)), np.zeros(1))
        floating = namespace(sample).isdtype(sample.dtype, "real floating")
        for port, value in self._values.items():
            rows = np.array(np.broadcast_to(value, (scenes, *value.shape)), dtype=float)
            readings[port] = match_device(rows, sample, sample.dtype if floating else None)
        filled = Inputs(
            inputs.module, inputs.step, readings, truths, inputs.running, inputs.at_read
        )
        outputs, past = self._inner.step(filled, past)
        return outputs, (scenes, past)
