"""The recurrent network that maps what a vehicle did to the wind that made it do so.

Components first: features are `[F, *batch]`. A column of a product has the same bits whatever the
other columns are, as long as their number is a multiple of 32.
"""

from dataclasses import dataclass

import torch
from torch import Tensor, nn
from typing_extensions import override

from faultpath_quadrotor.batching import Delivered, Read
from faultpath_quadrotor.predictors.base import STATE as CHANNELS
from faultpath_quadrotor.predictors.module import STEPS
from faultpath_quadrotor.predictors.network import Affine, GatedCell, draw_weights
from faultpath_quadrotor.reconstruction.base import Memory, Reconstruction

STATE = 18  # position, velocity, rotation matrix, body rate (paper, Section IV-A)
ACTION = 4
CODE = 32  # paper, appendix
HIDDEN = 64  # paper, appendix


class WindNetwork(nn.Module):
    """GRU over the completed intervals; its code, the latest state and the calibration give wind.

    Each interval is the state at its end and the command executed over it (paper, appendix).
    Inputs are standardised with the training pool's mean and spread, which are buffers of the
    checkpoint and are never computed anew; the output is in m/s. The command stays in N and rad/s:
    mass and thrust scale enter at the head alone, so a fault on them reaches the network there.
    """

    feature_mean: Tensor
    feature_std: Tensor
    calibration_mean: Tensor
    calibration_std: Tensor

    def __init__(self, calibrated: bool = True) -> None:
        super().__init__()
        self.calibrated = calibrated
        self.encoder = GatedCell(STATE + ACTION, CODE)
        self.hidden = Affine(CODE + STATE + (2 if calibrated else 0), HIDDEN)
        self.head = Affine(HIDDEN, 3)
        widths = {"feature": STATE + ACTION} | ({"calibration": 2} if calibrated else {})
        for name, width in widths.items():
            self.register_buffer(f"{name}_mean", torch.zeros(width, 1))
            self.register_buffer(f"{name}_std", torch.ones(width, 1))

    def initialise(self, generator: torch.Generator) -> None:
        """Draw all weights uniformly within one over the root of a layer's inputs."""
        draw_weights(self, generator)

    def measure(self, states: Tensor, commands: Tensor, calibration: Tensor) -> None:
        """Take the scales from a training pool; shapes as in `estimate`."""
        measured = {"feature": torch.cat((states, commands)).flatten(1)}
        if self.calibrated:
            measured["calibration"] = calibration
        for name, values in measured.items():
            std, mean = torch.std_mean(values.double(), dim=1, correction=0, keepdim=True)
            # What does not vary in the pool is left in its own unit.
            getattr(self, f"{name}_std").copy_(torch.where(std > 1e-6, std, 1.0))
            getattr(self, f"{name}_mean").copy_(mean)

    def inputs(self, states: Tensor, commands: Tensor) -> tuple[Tensor, Tensor]:
        """Return the standardised intervals `[22, 12, N]` and latest state `[18, N]`."""
        mean, std = self.feature_mean[..., None], self.feature_std[..., None]
        intervals = (torch.cat((states, commands)) - mean) / std
        return intervals, intervals[:STATE, -1]

    def calibration(self, delivered: Tensor) -> Tensor:
        """Return m~ and T~ `[2, N]`, standardised."""
        return (delivered - self.calibration_mean) / self.calibration_std

    def forward(
        self, intervals: Tensor, latest: Tensor, calibration: Tensor | None = None
    ) -> Tensor:
        """Return the wind `[3, N]`, m/s, of standardised inputs, the latest interval last."""
        parts = [self.encoder.last(intervals.movedim(1, 0)), latest]
        if calibration is not None:
            parts.append(calibration)
        return self.head(self.hidden(torch.cat(parts), gelu=True))

    def estimate(self, states: Tensor, commands: Tensor, calibration: Tensor | None) -> Tensor:
        """Return the wind `[3, N]`, m/s, world frame; it is never clipped.

        `states` are those at the intervals' ends, `[18, 12, N]`, `commands` `[4, 12, N]` what was
        executed over them, `calibration` the delivered m~ (kg) and T~, `[2, N]`.
        """
        supplied = None if calibration is None else self.calibration(calibration)
        return self(*self.inputs(states, commands), supplied)


_HISTORY: frozenset[Read] = frozenset((channel, "history") for channel in (*CHANNELS, "action"))
_HEAD: tuple[Read, Read] = (("mass", "head"), ("thrust_scale", "head"))
READS = _HISTORY.union(_HEAD)
"""All that such a reconstruction may read."""


@dataclass(frozen=True)
class RecurrentMemory:
    """The last 12 intervals, the latest last; nothing else is carried on."""

    states: Tensor
    """State at the end of each, `[18, 12, *batch]`."""
    commands: Tensor
    """Command executed over each, `[4, 12, *batch]`."""
    calibration: Tensor | None
    """m~ and T~ as last delivered, `[2, *batch]`."""


class RecurrentReconstruction(Reconstruction):
    """A GRU over the completed intervals (paper, Section V-B and appendix).

    Calibration enters at the head; a network built without it reads none anywhere.

    The estimate is computed anew from the last 12 completed intervals at each replan; no hidden
    state is carried on. Intervals before the flight are those of the hover that was executed then,
    where the vehicle is first seen.
    """

    def __init__(self, network: WindNetwork) -> None:
        self.reads: frozenset[Read] = _HISTORY.union(_HEAD if network.calibrated else ())
        self.network = network.eval()

    def begin(self, delivered: Delivered) -> Memory:
        """Start with a hover for all intervals; see `Reconstruction.begin`."""
        state, command = (
            value.expand(-1, STEPS, *value.shape[2:]) for value in _interval(delivered)
        )
        return RecurrentMemory(state, command, self._calibration(delivered))

    @override
    def update(self, memory: Memory, delivered: Delivered) -> Memory:
        past: RecurrentMemory = memory
        state, command = _interval(delivered)
        return RecurrentMemory(
            states=torch.cat((past.states[:, 1:], state), 1),
            commands=torch.cat((past.commands[:, 1:], command), 1),
            calibration=self._calibration(delivered),
        )

    @torch.no_grad()
    def wind(self, memory: Memory) -> Tensor:
        """See `Reconstruction.wind`; lanes come in multiples of 32."""
        known: RecurrentMemory = memory
        return self.network.estimate(known.states, known.commands, known.calibration)

    def _calibration(self, delivered: Delivered) -> Tensor | None:
        if not self.network.calibrated:
            return None
        return torch.stack([delivered[read] for read in _HEAD]).float()


def _interval(delivered: Delivered) -> tuple[Tensor, Tensor]:
    """Return the state at the end of an interval and the command over it, `[.., 1, *batch]`."""
    position, velocity, rotation, rate = (delivered[name, "history"] for name in CHANNELS)
    state = torch.cat((position, velocity, rotation.flatten(0, 1), rate))
    return state.float()[:, None], delivered["action", "history"].float()[:, None]
