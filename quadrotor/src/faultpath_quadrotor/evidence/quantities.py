"""The quantities of a measurement, each a number a window."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import torch
from torch import Tensor
from typing_extensions import override

from faultpath.core.errors import UserError
from faultpath_quadrotor.evidence.inputs import Subject
from faultpath_quadrotor.evidence.recording import Recorded, quadrotor
from faultpath_quadrotor.evidence.table import Measured, Measurement, Quantity
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.predictors.drag import LinearDrag
from faultpath_quadrotor.reconstruction import (
    Delivered,
    DisturbanceObserver,
    ObserverMemory,
    Sensed,
)
from faultpath_quadrotor.training.playback import Present, at_present
from faultpath_quadrotor.training.windows import HISTORY, Windows

Drag = Sequence[float]
"""By body axis, kg/s."""


def check(measurement: Measurement) -> None:
    """Raise `UserError` where the measurement does not fit the system, before anything flies."""
    subject = _subject(measurement)
    subject.check(measurement.faults)
    analytic = measurement.quantity in ("acceleration-error", "wind-term-error")
    if analytic and not {"dynamics", "wind_map"} <= subject.predictor.reads:
        raise UserError(
            f"the predictor of {measurement.subject!r} has no analytic dynamics with a wind input, "
            f"so {measurement.quantity} does not exist for it: measure a variant with a wind input"
        )


@torch.inference_mode()
def measured(measurement: Measurement, recorded: Recorded) -> Measured:
    """Measure on every window what `check` has let pass.

    A window's number does not depend on the windows beside it, to the bit, unless a fault on the
    history code exchanges them.
    """
    values = of_windows(_subject(measurement), measurement, recorded.windows)
    return Measured(recorded.scenes, recorded.steps, values.double().numpy())


def of_windows(subject: Subject, asked: Measurement, windows: Windows) -> Tensor:
    """Return what is asked of a variant, whichever its models are, on each window, `[W]`."""
    return _QUANTITIES[asked.quantity](subject, asked, windows)


def _subject(asked: Measurement) -> Subject:
    return Subject.load(quadrotor(asked.recording), asked.subject, asked.seed)


def _drag_kgps(subject: Subject) -> Drag:
    return PLATFORM.drag_kgps


def _present(subject: Subject, asked: Measurement, windows: Windows) -> Present:
    return subject.at_present(windows, asked.faults, asked.recording.name)


def _position_error(subject: Subject, asked: Measurement, windows: Windows) -> Tensor:
    last = _present(subject, asked, windows).positions()[..., -1]
    return (last - windows.position[:, -1]).norm(dim=0)


def _position_response(subject: Subject, asked: Measurement, windows: Windows) -> Tensor:
    correct = asked.model_copy(update={"faults": ()})
    here, there = (
        _present(subject, each, windows).positions()[..., -1] for each in (correct, asked)
    )
    return (there - here).norm(dim=0)


def _acceleration_error(subject: Subject, asked: Measurement, windows: Windows) -> Tensor:
    present = _present(subject, asked, windows)
    told = {channel: present[channel, "predictor.dynamics"] for channel in windows.calibration}
    drag = _drag_kgps(subject)
    believed = replace(windows, mass_kg=told["mass"], thrust_scale=told["thrust_scale"])
    return (
        (_nominal(believed, drag) - _nominal(windows, drag))
        + _wind_term_difference(present, windows, drag)
    ).norm(dim=0)


def _wind_term_error(subject: Subject, asked: Measurement, windows: Windows) -> Tensor:
    present = _present(subject, asked, windows)
    return _wind_term_difference(present, windows, _drag_kgps(subject)).norm(dim=0)


_QUANTITIES: Mapping[Quantity, Callable[[Subject, Measurement, Windows], Tensor]] = {
    "position-error": _position_error,
    "position-response": _position_response,
    "acceleration-error": _acceleration_error,
    "wind-term-error": _wind_term_error,
}


class _NominalAcceleration(DisturbanceObserver):
    """Gives, in the place of the wind, the acceleration a_0 that the observer explains itself.

    Paper, Section "Calibration-Dependent Compensation". What the observer takes out of an
    acceleration is thus put back here.
    """

    @override
    def update(self, memory: ObserverMemory, delivered: Delivered) -> ObserverMemory:
        explained = self.nominal(memory, Sensed.of(delivered))
        return replace(super().update(memory, delivered), wind_mps=explained)


def _nominal(windows: Windows, drag_kgps: Drag) -> Tensor:
    """Return a_0 over the interval that ends at the present, `[3, W]`, m/s^2.

    An observer told the calibration of these windows follows the whole history, for the thrust
    that the motors hold; the start of its belief has decayed by a factor of a million.
    """
    bindings = {"wind": "reconstructed_wind"}
    return at_present(windows, None, _NominalAcceleration(drag_kgps=drag_kgps), bindings).wind()


def _wind_term_difference(present: Present, windows: Windows, drag_kgps: Drag) -> Tensor:
    def term(map_mass_kg: Tensor, wind_mps: Tensor) -> Tensor:
        force = LinearDrag(drag_kgps).force(windows.rotation[:, :, HISTORY], wind_mps)
        return force / map_mass_kg

    believed = term(present["mass", "predictor.wind_map"], present.wind())
    return believed - term(windows.mass_kg, windows.wind_mps[:, HISTORY])
