"""Recorded windows in place of a flight: what taps deliver there, and what modules make of it.

Fitting, validation and evidence all come here. Modules, and the map from taps to their inputs
(`predictors.places`), are those of a flight; only where readings come from differs.
"""

from collections.abc import Callable, Collection, Iterator, Mapping

import torch
from torch import Tensor

from faultpath.interface import Interface
from faultpath.quadrotor.predictors import Physics, Predictor
from faultpath.quadrotor.predictors.places import Take, history, predictor_inputs
from faultpath.quadrotor.reconstruction import Reconstruction
from faultpath.quadrotor.reconstruction.base import Delivered, Memory
from faultpath.quadrotor.rollout import unroll
from faultpath.quadrotor.state import State, padded_lanes
from faultpath.quadrotor.training.windows import HISTORY, Windows
from faultpath.taps import Reading, Taps

DeliveredInputs = Mapping[tuple[str, str], Tensor]
"""What taps delivered at the windows' present, `[W, ...]`, by channel and consumer.

Calibration always comes from here, and is held over history and horizon. The wind and the history
code may; where they do not, they follow from the recording, as motion and commands always do.
"""

WIND = ("wind", "predictor.wind_map")
CODE = ("history_code", "predictor.latent")
BATCH = 512
"""Windows at a time: their tensors stay in the processor's cache."""


def deliver(
    taps: Taps, interface: Interface, consumers: Collection[str], readings: Mapping[str, Tensor]
) -> dict[tuple[str, str], Tensor]:
    """Return what `consumers` get of readings `[W, ...]`, which are given by channel."""
    return {
        (channel, consumer): taps.deliver(
            channel, consumer, Reading(value, taps.bindings[channel], 0), 0
        )
        for channel, value in readings.items()
        for consumer in interface.channel(channel).consumers
        if consumer in consumers
    }


def correct(model: Predictor | Reconstruction, windows: Windows) -> DeliveredInputs:
    """Return the true calibration at every place at which a model reads it."""
    return {
        (channel, consumer): value
        for channel, value in windows.calibration.items()
        for consumer in model.consumers()
    }


def predict(predictor: Predictor, windows: Windows, delivered: DeliveredInputs) -> Iterator[State]:
    """Yield the predicted states 13 to 32 of every window, batch `[W, 1]`.

    The wind of the present is held over the horizon.
    """
    if "history" in predictor.reads and CODE not in delivered:
        delivered = {**delivered, CODE: encode(predictor, windows, delivered).T}
    inputs = predictor_inputs(predictor.reads, _taps(windows, delivered, "predictor", HISTORY))
    commands = windows.command[:, HISTORY:].movedim(1, 0)[..., None]
    return unroll(predictor, inputs, commands)


def encode(predictor: Predictor, windows: Windows, delivered: DeliveredInputs) -> Tensor:
    """Return the code `[32, W]` of every window's history, of a predictor that reads one."""
    past = slice(0, HISTORY)
    code = predictor.encode(
        history(predictor.reads, _taps(windows, delivered, "predictor", past, past))
    )
    assert code is not None
    return code


def remembered(
    reconstruction: Reconstruction,
    windows: Windows,
    delivered: DeliveredInputs,
    intervals: int = HISTORY,
) -> Memory:
    """Return what a module that starts at state 0 remembers after so many intervals."""
    memory = reconstruction.begin(inputs_at(reconstruction, windows, delivered, 0))
    for step in range(1, intervals + 1):
        memory = reconstruction.update(memory, inputs_at(reconstruction, windows, delivered, step))
    return memory


def inputs_at(
    reconstruction: Reconstruction, windows: Windows, delivered: DeliveredInputs, step: int
) -> Delivered:
    """Return what a module reads at state `step`; at the first, the command means nothing."""
    take = _taps(windows, delivered, "reconstruction", step, max(step - 1, 0))
    return {read: take(*read) for read in reconstruction.reads}


def estimate(
    reconstruction: Reconstruction,
    windows: Windows,
    delivered: DeliveredInputs,
    padded: bool = False,
) -> Tensor:
    """Return the wind at the present of every window, `[3, W]`, m/s; see `by_batch`."""

    def wind(windows: Windows, delivered: DeliveredInputs) -> Tensor:
        return reconstruction.wind(remembered(reconstruction, windows, delivered))

    return by_batch(wind, windows, delivered, padded)


def by_batch(
    compute: Callable[[Windows, DeliveredInputs], Tensor],
    windows: Windows,
    delivered: DeliveredInputs,
    padded: bool = False,
) -> Tensor:
    """Return what `compute` makes of windows, `[..., W]`, some of them at a time.

    With `padded`, the last are filled up to a multiple of 32: no window's bits then depend on how
    many there are.
    """
    lanes = padded_lanes(len(windows)) if padded else torch.arange(len(windows))
    found = [
        compute(windows.take(index), {tap: value[index] for tap, value in delivered.items()})
        for index in lanes.split(BATCH)
    ]
    return torch.cat(found, -1)[..., : len(windows)]


def _taps(
    windows: Windows,
    delivered: DeliveredInputs,
    module: str,
    states: int | slice,
    commands: int | slice = 0,
) -> Take:
    """Return what takes a module's readings, `[..., W]`; of a slice of states, `[..., T, W]`."""
    recorded = {
        "position": windows.position,
        "velocity": windows.velocity,
        "attitude": windows.rotation,
        "body_rate": windows.rate,
        "wind": windows.wind_mps,
    }

    def take(channel: str, place: str) -> Tensor:
        tap = (channel, f"{module}.{place}")
        if tap in delivered:
            return delivered[tap].movedim(0, -1).contiguous()
        if channel == "action":
            return windows.command[:, commands]
        if channel == "physics":
            return _physics(windows)
        return recorded[channel][..., states, :]

    return take


def _physics(windows: Windows) -> Tensor:
    return Physics(
        windows.inertia_kgm2,
        windows.torque_scale,
        windows.motor_time_constant_s,
        windows.drag_kgps,
        windows.motor_thrust_n[HISTORY],
    ).reading()
