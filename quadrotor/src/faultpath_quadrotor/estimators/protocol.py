"""Estimators as the loop runs them, and the exact one."""

from collections.abc import Collection, Iterable, Sequence
from os import PathLike

from torch import Tensor

from faultpath.interface import Channel, Interface, Provenance, Source
from faultpath.loop import Inputs, Memory, Module, Outputs, Part
from faultpath_quadrotor.choices import Fixes
from faultpath_quadrotor.estimators.sensors import raw, sensors

STATE_SOURCES = {
    "position": "position_estimate",
    "velocity": "velocity_estimate",
    "attitude": "attitude_estimate",
    "body_rate": "body_rate_measurement",
}
CALIBRATION_SOURCES = {"mass": "mass_estimate", "thrust_scale": "thrust_scale_estimate"}
SOURCES = CALIBRATION_SOURCES | STATE_SOURCES
"""Sources of what the controller knows of the vehicle, by the name of the truth."""


class Estimator(Module):
    """Turns what the plant senses into what the controller knows of the vehicle, but not the wind:
    that is a `Reconstruction`'s.

    It writes some of the sources in `SOURCES`, `[B, ...]` each; the exact estimator writes the
    rest. It may read any channel of the interface, and the raw sensors of `estimators.sensors`.
    """

    name = "estimator"
    writes = tuple(STATE_SOURCES.values())
    data_files: Sequence[str | PathLike[str]] | None = None
    """Files that a user's own estimator reads, of every seed, such as weights."""


def with_estimators(
    interface: Interface, parts: Iterable[Part], fixes: Fixes = Fixes.OPTICAL
) -> Interface:
    """Return the interface with the raw sensors that some modules read, and those readers.

    Estimators are added as readers of every channel that they read.
    """
    known = sensors(fixes)
    readers: dict[str, set[str]] = {}
    for part in parts:
        for port in part.ports:
            if port.channel in known or isinstance(part, Estimator):
                readers.setdefault(port.channel, set()).add(part.reader(port))
    channels = [
        channel.model_copy(
            update={"readers": (*channel.readers, *sorted(readers.pop(channel.name, ())))}
        )
        for channel in interface.channels
    ]
    sources = list(interface.sources)
    for name in sorted(readers.keys() & known.keys()):
        sensor = known[name]
        sources.append(
            Source(
                name=raw(name),
                unit=sensor.unit,
                shape=sensor.shape,
                provenance=Provenance.MEASURED,
                rate_hz=sensor.rate_hz,
                latency_s=sensor.latency_s,
                description=sensor.description,
            )
        )
        channels.append(
            Channel(
                name=name,
                sources=(raw(name),),
                readers=tuple(sorted(readers[name])),
                description=sensor.description,
            )
        )
    return interface.model_copy(update={"sources": tuple(sources), "channels": tuple(channels)})


class ExactEstimator(Estimator):
    """Estimates without error (the paper's): the one module that takes the plant's truth past all
    taps. It leaves out the sources `besides`, which another estimator writes.
    """

    truths = ("vehicle",)

    def __init__(self, besides: Collection[str] = ()) -> None:
        self._names = {name: s for name, s in SOURCES.items() if s not in besides}
        self.writes = tuple(self._names.values())

    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Return the truth, `[B, ...]` each."""
        truth: dict[str, Tensor] = inputs.truth("vehicle")
        return {source: truth[name] for name, source in self._names.items()}, memory
