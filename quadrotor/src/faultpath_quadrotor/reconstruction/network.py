"""The recurrent network that maps what a vehicle did to the wind that made it do so.

Components first: features are `[F, *batch]`. A column of a product has the same bits whatever the
other columns are, as long as their number is a multiple of 32.
"""

from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn import functional
from typing_extensions import override

from faultpath_quadrotor.lanes import Delivered, Read
from faultpath_quadrotor.predictors.network import Affine, GatedCell, draw_weights
from faultpath_quadrotor.reconstruction.base import Memory, Reconstruction

INTERVALS = 12  # paper, appendix: completed 20 Hz intervals
STATE = 18  # position, velocity, rotation matrix, body rate (paper, Section IV-A)
ACTION = 4
CODE = 32  # paper, appendix
HIDDEN = 64  # paper, appendix


class WindNetwork(nn.Module):
    """GRU over the completed intervals; its code, the latest state and the calibration give wind.

    Each interval is the state at its end and the command executed over it (paper, appendix). All
    inputs and the target are standardised with the training pool's mean and spread, which are
    buffers of the checkpoint and are never computed anew. The command stays in N and rad/s: mass
    and thrust scale enter at the head alone, so a fault on them reaches the network there.

    Positions are relative to the latest one. Absolute ones would tie the network to the arena that
    it was trained in; wind is the same everywhere. The latest position is therefore zero, and the
    head's three inputs for it carry nothing.
    """

    feature_mean: Tensor
    feature_std: Tensor
    calibration_mean: Tensor
    calibration_std: Tensor
    wind_mean: Tensor
    wind_std: Tensor

    def __init__(self, calibrated: bool = True) -> None:
        super().__init__()
        self.calibrated = calibrated
        self.encoder = GatedCell(STATE + ACTION, CODE)
        self.hidden = Affine(CODE + STATE + (2 if calibrated else 0), HIDDEN)
        self.head = Affine(HIDDEN, 3)
        widths = {"feature": STATE + ACTION, "wind": 3} | ({"calibration": 2} if calibrated else {})
        for name, width in widths.items():
            self.register_buffer(f"{name}_mean", torch.zeros(width, 1))
            self.register_buffer(f"{name}_std", torch.ones(width, 1))

    def initialise(self, generator: torch.Generator) -> None:
        """Draw all weights uniformly within one over the root of a layer's inputs."""
        draw_weights(self, generator)

    def measure(self, states: Tensor, commands: Tensor, calibration: Tensor, wind: Tensor) -> None:
        """Take the scales from a training pool; shapes as in `estimate`, wind `[3, N]` m/s."""
        raw = torch.cat((relative(states)[:, 1:], commands)).flatten(1)
        measured = {"feature": raw, "wind": wind}
        if self.calibrated:
            measured["calibration"] = calibration
        for name, values in measured.items():
            std, mean = torch.std_mean(values.double(), dim=1, correction=0, keepdim=True)
            # What does not vary in the pool is left in its own unit.
            getattr(self, f"{name}_std").copy_(torch.where(std > 1e-6, std, 1.0))
            getattr(self, f"{name}_mean").copy_(mean)

    def inputs(self, states: Tensor, commands: Tensor) -> tuple[Tensor, Tensor]:
        """Return the standardised intervals `[22, n, N]` and latest state `[18, N]`."""
        near = relative(states)
        mean, std = self.feature_mean[..., None], self.feature_std[..., None]
        intervals = (torch.cat((near[:, 1:], commands)) - mean) / std
        latest = (near[:, -1] - self.feature_mean[:STATE]) / self.feature_std[:STATE]
        return intervals, latest

    def calibration(self, delivered: Tensor) -> Tensor:
        """Return m~ and T~ `[2, N]`, standardised."""
        return (delivered - self.calibration_mean) / self.calibration_std

    def target(self, wind: Tensor) -> Tensor:
        """Return wind `[3, N]`, m/s, standardised."""
        return (wind - self.wind_mean) / self.wind_std

    def encode(self, intervals: Tensor, known: Tensor | None = None) -> Tensor:
        """Return the code `[32, N]` of `[22, n, N]`; the latest interval is the last.

        `known` `[N]` counts the intervals that each column has: earlier ones leave its code at
        zero. Without it all have all of them.
        """
        if known is None:
            return self.encoder.last(intervals.movedim(1, 0))
        count = intervals.shape[1]
        code = intervals.new_zeros(CODE, intervals.shape[-1])
        for step, interval in enumerate(intervals.unbind(1)):
            after = self.encoder(interval, code)
            code = torch.where(known >= count - step, after, code)
        return code

    def forward(
        self,
        intervals: Tensor,
        latest: Tensor,
        calibration: Tensor | None = None,
        known: Tensor | None = None,
    ) -> Tensor:
        """Return the standardised wind `[3, N]` of standardised inputs."""
        given = [self.encode(intervals, known), latest]
        if calibration is not None:
            given.append(calibration)
        return self.head(functional.gelu(self.hidden(torch.cat(given))))

    def estimate(self, states: Tensor, commands: Tensor, calibration: Tensor | None) -> Tensor:
        """Return the wind `[3, N]`, m/s, world frame; it is never clipped.

        Args:
            states: Where the vehicle was at the start and at each interval's end,
                `[18, n + 1, N]` with n from 1 to 12.
            commands: What was executed over each interval, `[4, n, N]`, N and rad/s.
            calibration: Delivered m~ (kg) and T~, `[2, N]`; `None` where it is withheld.
        """
        supplied = None if calibration is None else self.calibration(calibration)
        wind = self(*self.inputs(states, commands), supplied)
        return wind * self.wind_std + self.wind_mean


def relative(states: Tensor) -> Tensor:
    """Return states `[18, n + 1, N]` with positions relative to the latest one."""
    return torch.cat((states[:3] - states[:3, -1:], states[3:]))


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
