"""The error-state Kalman filter as a module of the loop: raw sensors in, the state out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor
from typing_extensions import override

from faultpath.loop import Outputs, Port
from faultpath_quadrotor.batching import Delivered, LaneModule
from faultpath_quadrotor.device import CPU
from faultpath_quadrotor.estimators.kalman import (
    Belief,
    Increment,
    Innovation,
    Trust,
    carried,
    corrected,
    predicted,
)
from faultpath_quadrotor.estimators.protocol import STATE_SOURCES, Estimator
from faultpath_quadrotor.estimators.sensors import SENSORS

AT = "filter"
_INERTIAL, _AIDING = SENSORS[:2], SENSORS[2:]


@dataclass(frozen=True)
class Filtered:
    """The belief of some steps ago, and the readings since."""

    belief: Belief
    """Belief at the step whose fix may have arrived by now, at first that at the start."""
    inertial: tuple[tuple[Tensor, Tensor], ...]
    """Readings of gyroscope and accelerometer over the intervals since."""
    aiding: tuple[Mapping[str, Tensor], ...]
    """Altitude and heading of the belief's step and of those since."""
    innovations: tuple[Innovation, ...] = ()
    """Innovations of the last correction."""

    def now(self) -> tuple[Tensor, Tensor, Tensor]:
        """Return position, velocity and attitude of the last reading's step."""
        belief = self.belief
        pose = (belief.position, belief.velocity, belief.rotation)
        if self.inertial:
            rate, force = map(torch.stack, zip(*self.inertial, strict=True))
            rate = (rate - belief.gyroscope_bias).transpose(0, 1)  # [SAMPLES, n, 3, L]
            force = (force - belief.accelerometer_bias).transpose(0, 1)
            for interval in range(len(self.inertial)):
                pose = carried(*pose, Increment.of(rate[:, interval], force[:, interval]))
        return pose


class ErrorStateFilter(LaneModule, Estimator):
    """Position, velocity, attitude and body rate from the raw sensors of `estimators.sensors`.

    A fix is some steps old when it arrives. The filter's belief therefore stays at that step: other
    readings are kept and taken in at their own step, and the present follows from the inertial
    samples since, as in PX4's EKF2. Rates and latencies are the declared ones; the filter does not
    know of a fault that delays fixes further. The vehicle starts at rest on level ground.
    """

    reads = frozenset(Port(name, AT) for name in SENSORS)

    def __init__(self, trust: Trust, device: torch.device = CPU) -> None:
        super().__init__(device)
        self.trust = trust

    @override
    def compute(
        self, readings: Delivered, step: int, memory: Filtered | None
    ) -> tuple[Outputs, Filtered]:
        read = {name: readings[name, AT] for name in SENSORS}
        known = self.begun(read) if memory is None else self.taken(memory, read, step)
        estimates = self.estimates(known, read)
        return {STATE_SOURCES[name]: value for name, value in estimates.items()}, known

    def estimates(self, known: Filtered, read: Mapping[str, Tensor]) -> Mapping[str, Tensor]:
        """Return the estimates `[..., L]` by channel at the step of `read`."""
        position, velocity, attitude = known.now()
        *_, before, last = read["gyroscope"]  # means over 10 ms: the present is half of that ahead
        rate = last + 0.5 * (last - before) - known.belief.gyroscope_bias
        return dict(zip(STATE_SOURCES, (position, velocity, attitude, rate), strict=True))

    def begun(self, read: Mapping[str, Tensor]) -> Filtered:
        """Return the memory after the first readings, `[..., L]` by channel."""
        belief = Belief.at_rest(read["position_fix"], read["heading"], self.trust)
        return Filtered(belief, (), (read,))

    def taken(self, past: Filtered, read: Mapping[str, Tensor], step: int) -> Filtered:
        """Return the memory after the readings of a later step."""
        fix = self.trust.sensors["position_fix"]
        inertial = (*past.inertial, (read["gyroscope"], read["accelerometer"]))
        aiding = (*past.aiding, read)
        if len(inertial) <= fix.late:
            return Filtered(past.belief, inertial, aiding)
        (rate, force), *later = inertial
        belief = past.belief
        by = Increment.of(rate - belief.gyroscope_bias, force - belief.accelerometer_bias)
        due = {name: aiding[1][name] for name in ("altitude", "heading")}
        if fix.sampled(step - fix.late):
            due["position_fix"] = read["position_fix"]
        belief, innovations = corrected(predicted(belief, by, self.trust), due, self.trust)
        return Filtered(belief, tuple(later), aiding[1:], tuple(innovations))
