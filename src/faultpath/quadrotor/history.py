"""What a learned predictor remembers of the executed flight: its last intervals, behind taps."""

from dataclasses import dataclass

import torch
from torch import Tensor

from faultpath.quadrotor.predictors import Calibration, History
from faultpath.quadrotor.sensors import Sensors, lanes_last
from faultpath.quadrotor.vehicle import GRAVITY_MPS2
from faultpath.taps import ModuleTaps, Reading

STEPS = 12  # paper, Section IV-A

_CHANNELS = ("velocity", "attitude", "body_rate")


@dataclass(frozen=True)
class _Motion:
    velocity: Tensor
    rotation: Tensor
    rate: Tensor


class HistoryRecord:
    """The last 12 intervals of every lane, as delivered when they were new.

    Before the first interval the vehicle is taken to have hovered where it is first seen, under the
    thrust that holds it by the supplied calibration. The supplied mass normalises the whole record
    anew at each replan.
    """

    def __init__(self, taps: ModuleTaps, lanes: Tensor) -> None:
        self._taps = taps
        self._lanes = lanes
        self._past: list[tuple[_Motion, Tensor]] = []
        self._latest: _Motion | None = None

    def observe(
        self,
        sensors: Sensors,
        executed: Reading,
        trim: Calibration,
        conditioning: Calibration | None,
        step: int,
    ) -> History:
        """Take the step's readings in and return the history, batch `[L]`.

        `trim` gives the thrust of the hover before the start, `conditioning` what a predictor
        appends to its features; both are as delivered, batch `[L, 1]`.
        """
        motion = _Motion(*(self._take(name, sensors.readings[name], step) for name in _CHANNELS))
        command = self._take("action", executed, step)
        if self._latest is None:
            hover = torch.zeros_like(command)
            hover[0] = trim.hover_thrust(GRAVITY_MPS2)[:, 0]
            self._past = [(motion, hover)] * STEPS
        else:
            self._past = [*self._past[1:], (self._latest, command)]
        self._latest = motion
        motions, commands = zip(*self._past, strict=True)
        return History(
            velocity_mps=torch.stack([m.velocity for m in motions], 1),
            rotation=torch.stack([m.rotation for m in motions], 2),
            rate_radps=torch.stack([m.rate for m in motions], 1),
            commands=torch.stack(commands, 1),
            mass_kg=self._take("mass", sensors.readings["mass"], step),
            conditioning=conditioning and conditioning.squeeze(),
        )

    def _take(self, channel: str, reading: Reading, step: int) -> Tensor:
        return lanes_last(
            self._taps.deliver(channel, "history", reading, step), self._lanes
        ).float()
