"""The raw sensors that an estimator may read: what each gives, when, and how it errs."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
import torch
from torch import Tensor

from faultpath.plugin.system import generator
from faultpath_quadrotor import so3
from faultpath_quadrotor.choices import Fixes
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import CONTROL_DT_S, CONTROL_RATE_HZ, GRAVITY_MPS2

SAMPLES = 5
"""Samples of gyroscope and accelerometer in a reading: 100 Hz, each a mean over 10 ms, as inertial
units deliver what they integrate."""
SAMPLE_DT_S = CONTROL_DT_S / SAMPLES


@dataclass(frozen=True)
class Sensor:
    """A sensor: what it gives to an estimator, and its errors for `sensor_noise` 1."""

    unit: str
    description: str
    shape: tuple[int, ...]
    noise: float
    """Standard deviation of a sample."""
    bias: float = 0.0
    """Standard deviation of the offset that a trial begins with."""
    walk: float = 0.0
    """Standard deviation of the change of that offset in a second."""
    scale: float = 0.0
    """Standard deviation of an axis's scale error, and of the angles between axes, rad."""
    rate_hz: float = float(CONTROL_RATE_HZ)
    """Rate of its readings."""
    latency_s: float = 0.0

    @property
    def late(self) -> int:
        """Control steps after which a reading arrives, as the loop rounds them."""
        return math.ceil(self.latency_s / CONTROL_DT_S - 1e-6)

    def sampled(self, step: int) -> bool:
        """Return whether it takes a reading at a control step."""
        ticks = self.rate_hz / CONTROL_RATE_HZ
        return math.floor(step * ticks + 1e-6) != math.floor((step - 1) * ticks + 1e-6)


_INERTIAL = (SAMPLES, 3)
_SENSORS = {
    "gyroscope": Sensor(
        "rad/s",
        f"Angular velocity in the body frame, {SAMPLES} means over 10 ms.",
        _INERTIAL,
        noise=0.01,
        bias=0.01,
        walk=0.0005,
        scale=0.0005,
    ),
    "accelerometer": Sensor(
        "m/s^2",
        f"Acceleration without gravity in the body frame, {SAMPLES} means over 10 ms.",
        _INERTIAL,
        noise=0.1,
        bias=0.1,
        walk=0.005,
        scale=0.0005,
    ),
    "position_fix": Sensor(
        "m", "Position in the world frame.", (3,), noise=0.02, rate_hz=10.0, latency_s=0.06
    ),
    "altitude": Sensor("m", "Height above the floor, by a level range finder.", (), noise=0.02),
    "heading": Sensor("rad", "Direction of the body's x axis over the floor.", (), noise=0.02),
}
_PRESETS = {
    Fixes.OPTICAL: _SENSORS["position_fix"],
    Fixes.SATELLITE: replace(_SENSORS["position_fix"], noise=0.25, bias=0.5, walk=0.05),
}
SENSORS = tuple(_SENSORS)
"""Their channels; the source behind each is `<channel>_raw`."""


def sensors(fixes: Fixes = Fixes.OPTICAL) -> Mapping[str, Sensor]:
    """Return the sensors by channel.

    Their errors are those of a small MEMS unit on a shaking frame, of an indoor positioning system
    and of satellite positions without corrections (derived).
    """
    return MappingProxyType({**_SENSORS, "position_fix": _PRESETS[fixes]})


def raw(channel: str) -> str:
    """Return the source behind a raw sensor's channel."""
    return f"{channel}_raw"


def readings(passed: Sequence[State]) -> Mapping[str, Tensor]:
    """Return what exact sensors give, `[..., L]` by channel.

    `passed` holds the states of the last control interval at the ends of its `SAMPLES` parts, the
    present one last. Its samples are the means that lead from each to the next.
    """
    present = passed[-1]
    rotation = torch.stack([state.rotation for state in passed], 2)
    velocity = torch.stack([state.velocity for state in passed], 1)
    before, after = rotation[:, :, :-1], rotation[:, :, 1:]
    turn = so3.log(so3.compose(before.transpose(0, 1), after))
    pushed = (velocity[:, 1:] - velocity[:, :-1]) / SAMPLE_DT_S
    pushed[2] += GRAVITY_MPS2
    force = so3.rotate_back(so3.compose(before, so3.exp(0.5 * turn)), pushed)
    return {
        "gyroscope": (turn / SAMPLE_DT_S).transpose(0, 1),
        "accelerometer": force.transpose(0, 1),
        "position_fix": present.position,
        "altitude": present.position[2],
        "heading": so3.heading(present.rotation),
    }


class SensorErrors:
    """The errors of sensors in some scenes, drawn by scene and seed for a whole trial."""

    def __init__(
        self, scenes: Sequence[str], seed: int, size: float, known: Mapping[str, Sensor], steps: int
    ) -> None:
        self._size = size
        self._drawn = {
            name: [
                torch.from_numpy(np.stack(part))
                for part in zip(*(_draw(name, sensor, s, seed, steps) for s in scenes), strict=True)
            ]
            for name, sensor in (known.items() if size else ())
        }

    def on(self, name: str, step: int, exact: Tensor) -> Tensor:
        """Return what a sensor reads at a step where it would be `exact`, `[B, ...]`."""
        if not self._size:
            return exact
        mixed, added = self._drawn[name]
        wrong = added[:, step].to(exact)
        if exact.ndim == 3:
            wrong = wrong + (exact[:, :, None] * mixed.to(exact)[:, None]).sum(-1)
        return exact + self._size * wrong


def _draw(
    name: str, sensor: Sensor, scene: str, seed: int, steps: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return how axes are mixed, `[3, 3]`, and what is added at each step, `[T, ...]`."""
    stream = generator(f"sensor/{name}", scene, seed)
    mixed = sensor.scale * stream.standard_normal((3, 3))
    axes = sensor.shape[-1:]
    first = sensor.bias * stream.standard_normal(axes)
    grown = sensor.walk * math.sqrt(CONTROL_DT_S) * stream.standard_normal((steps, *axes))
    bias = (first + np.cumsum(grown, axis=0)).reshape(steps, *(1,) * len(sensor.shape[:-1]), *axes)
    return mixed, bias + sensor.noise * stream.standard_normal((steps, *sensor.shape))
