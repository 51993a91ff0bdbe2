"""What an estimator is to the loop, and the raw sensors that it may read."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from types import MappingProxyType

import numpy as np
import torch
from torch import Tensor

from faultpath.core.streams import generator
from faultpath.interface import Channel, Interface, Provenance, Source
from faultpath.loop import Inputs, Memory, Module, Outputs

STATE_SOURCES = {
    "position": "position_estimate",
    "velocity": "velocity_estimate",
    "attitude": "attitude_estimate",
    "body_rate": "body_rate_measurement",
}
CALIBRATION_SOURCES = {"mass": "mass_estimate", "thrust_scale": "thrust_scale_estimate"}
SOURCES = CALIBRATION_SOURCES | STATE_SOURCES
"""What the controller knows of the vehicle, by the name of the truth."""


class Estimator(Module):
    """Turns what the plant senses into what the controller knows of the vehicle.

    It writes some of the sources in `SOURCES`, `[B, ...]` each; the exact estimator writes the
    rest. It may read any channel of the interface, the raw sensors of `SENSORS` among them.
    """

    name = "estimator"
    writes = tuple(STATE_SOURCES.values())
    data_files: Sequence[str | PathLike[str]] | None = None
    """Of one that a user brings: the files that it reads, of every seed, such as weights."""


@dataclass(frozen=True)
class Sensor:
    """A raw sensor of three axes, sampled at the control rate."""

    unit: str
    noise: float
    """Standard deviation of a sample, for `sensor_noise` 1."""
    bias: float
    """Standard deviation of an offset that a trial keeps, for `sensor_noise` 1."""
    description: str


SENSORS: Mapping[str, Sensor] = MappingProxyType(
    {
        "gyroscope": Sensor("rad/s", 0.01, 0.01, "Angular velocity in the body frame, raw."),
        "specific_force": Sensor(
            "m/s^2", 0.1, 0.1, "Acceleration without gravity in the body frame, raw."
        ),
        "position_fix": Sensor("m", 0.02, 0.0, "Position in the world frame, of one sample."),
    }
)
"""By channel; its source is `<channel>_raw`. Noise and bias are those of a small MEMS unit and of
an indoor positioning system (derived)."""


def raw(channel: str) -> str:
    """Return the source behind a raw sensor's channel."""
    return f"{channel}_raw"


def with_estimators(interface: Interface, estimators: Iterable[Estimator]) -> Interface:
    """Return the interface with the consumers of estimators, and the raw sensors that they read."""
    consumers: dict[str, set[str]] = {}
    for estimator in estimators:
        for port in estimator.ports:
            consumers.setdefault(port.channel, set()).add(f"{estimator.name}.{port.place}")
    channels = [
        each.model_copy(
            update={"consumers": (*each.consumers, *sorted(consumers.pop(each.name, ())))}
        )
        for each in interface.channels
    ]
    sources = list(interface.sources)
    for name in sorted(consumers.keys() & SENSORS.keys()):
        sensor = SENSORS[name]
        sources.append(
            Source(
                name=raw(name),
                unit=sensor.unit,
                shape=(3,),
                provenance=Provenance.MEASURED,
                rate_hz=20.0,
                description=sensor.description,
            )
        )
        channels.append(
            Channel(
                name=name,
                sources=(raw(name),),
                consumers=tuple(sorted(consumers[name])),
                description=sensor.description,
            )
        )
    return interface.model_copy(update={"sources": tuple(sources), "channels": tuple(channels)})


class Errors:
    """Noise and bias of the raw sensors in some scenes, drawn by scene, seed and step."""

    def __init__(self, scenes: Sequence[str], seed: int, size: float) -> None:
        self._scenes, self._seed, self._size = scenes, seed, size

    def of(self, name: str, step: int, like: Tensor) -> Tensor:
        """Return the errors of a sensor's samples at a step, `[B, 3]`."""
        if not self._size:
            return torch.zeros_like(like)
        sensor, purpose = SENSORS[name], f"sensor/{name}"
        drawn = [
            sensor.bias * generator(purpose, scene, self._seed).standard_normal(3)
            + sensor.noise * generator(purpose, scene, self._seed, step + 1).standard_normal(3)
            for scene in self._scenes
        ]
        return torch.from_numpy(self._size * np.stack(drawn)).to(like)


class ExactEstimator(Estimator):
    """Estimates without error (the paper's): the one module that takes the plant's truth past all
    taps.

    Args:
        besides: Sources that another estimator writes.
    """

    truths = ("vehicle",)

    def __init__(self, besides: Collection[str] = ()) -> None:
        self._names = {name: s for name, s in SOURCES.items() if s not in besides}
        self.writes = tuple(self._names.values())

    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Return the truth, `[B, ...]` each."""
        truth: dict[str, Tensor] = inputs.truth("vehicle")
        return {source: truth[name] for name, source in self._names.items()}, memory
