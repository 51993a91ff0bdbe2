"""The learned wind reconstruction behind the interface of a `Reconstruction`."""

from dataclasses import dataclass

import torch
from torch import Tensor
from typing_extensions import override

from faultpath_quadrotor.reconstruction.base import Delivered, Memory, Read, Reconstruction
from faultpath_quadrotor.reconstruction.network import INTERVALS, WindNetwork

_STATE_CHANNELS = ("position", "velocity", "attitude", "body_rate")
_HISTORY: frozenset[Read] = frozenset(
    (channel, "history") for channel in (*_STATE_CHANNELS, "action")
)
_HEAD: tuple[Read, Read] = (("mass", "head"), ("thrust_scale", "head"))
READS = _HISTORY.union(_HEAD)
"""All that such a reconstruction may read."""


@dataclass(frozen=True)
class RecurrentMemory:
    """The completed intervals, at most 12, the latest last; nothing else is carried on."""

    states: Tensor
    """At the start of the first interval and at the end of each, `[18, n + 1, *batch]`."""
    commands: Tensor
    """Executed over each interval, `[4, n, *batch]`."""
    calibration: Tensor | None
    """m~ and T~ as last delivered, `[2, *batch]`."""


class RecurrentReconstruction(Reconstruction):
    """A GRU over the completed intervals (paper, Section V-B and appendix).

    Calibration enters at the head; a network built without it reads none anywhere.

    The estimate is computed anew from the last 12 completed intervals at each replan; no hidden
    state is carried on. Before the first is complete it is zero, as the observer's. While fewer
    than 12 are, the network runs over those that are, from a hidden state of zero; it was trained
    with such histories as well.
    """

    def __init__(self, network: WindNetwork) -> None:
        self.reads: frozenset[Read] = _HISTORY.union(_HEAD if network.calibrated else ())
        self.network = network.eval()

    def begin(self, delivered: Delivered) -> Memory:
        """Start without a completed interval; see `Reconstruction.begin`."""
        state = _state(delivered)
        none = state.new_zeros(4, 0, *state.shape[2:])
        return RecurrentMemory(state, none, self._calibration(delivered))

    @override
    def update(self, memory: Memory, delivered: Delivered) -> Memory:
        past: RecurrentMemory = memory
        command = delivered["action", "history"].float()[:, None]
        return RecurrentMemory(
            states=torch.cat((past.states, _state(delivered)), 1)[:, -INTERVALS - 1 :],
            commands=torch.cat((past.commands, command), 1)[:, -INTERVALS:],
            calibration=self._calibration(delivered),
        )

    @torch.no_grad()
    def wind(self, memory: Memory) -> Tensor:
        """See `Reconstruction.wind`; lanes come in multiples of 32."""
        known: RecurrentMemory = memory
        if not known.commands.shape[1]:
            return torch.zeros_like(known.states[:3, 0])
        return self.network.estimate(known.states, known.commands, known.calibration)

    def _calibration(self, delivered: Delivered) -> Tensor | None:
        if not self.network.calibrated:
            return None
        return torch.stack([delivered[read] for read in _HEAD]).float()


def _state(delivered: Delivered) -> Tensor:
    parts = [delivered[channel, "history"] for channel in _STATE_CHANNELS]
    position, velocity, rotation, rate = parts
    return torch.cat((position, velocity, rotation.flatten(0, 1), rate)).float()[:, None]
