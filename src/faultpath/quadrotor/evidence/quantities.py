"""The quantities of a measurement, each a number a window."""

from collections.abc import Callable, Mapping

import torch
from torch import Tensor

from faultpath.errors import UserError
from faultpath.evidence import Measured, Measurement, Quantity
from faultpath.quadrotor.evidence.compensation import nominal, wind_term
from faultpath.quadrotor.evidence.inputs import Subject
from faultpath.quadrotor.evidence.recording import Recorded, quadrotor
from faultpath.quadrotor.predictors import Calibration, Predictor
from faultpath.quadrotor.state import padded_lanes
from faultpath.quadrotor.training.replay import WIND, DeliveredInputs, by_batch, predict
from faultpath.quadrotor.training.windows import HISTORY, Windows


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
    quantity = _QUANTITIES[measurement.quantity]
    values = quantity(_subject(measurement), measurement, recorded.windows)
    return Measured(recorded.scenes, recorded.steps, values.double().numpy())


def _position_error(subject: Subject, asked: Measurement, windows: Windows) -> Tensor:
    delivered = _delivered(subject, asked, windows)
    return (final_positions(subject.predictor, windows, delivered) - windows.position[:, -1]).norm(
        dim=0
    )


def _position_response(subject: Subject, asked: Measurement, windows: Windows) -> Tensor:
    correct = asked.model_copy(update={"faults": ()})
    here, there = (
        final_positions(subject.predictor, windows, _delivered(subject, each, windows))
        for each in (correct, asked)
    )
    return (there - here).norm(dim=0)


def _acceleration_error(subject: Subject, asked: Measurement, windows: Windows) -> Tensor:
    delivered = _delivered(subject, asked, windows)
    calibration = Calibration(
        *(delivered[channel, "predictor.dynamics"] for channel in windows.calibration)
    )
    return (
        (_nominal(windows, calibration) - _nominal(windows, _true(windows)))
        + _wind_term_difference(windows, delivered)
    ).norm(dim=0)


def _wind_term_error(subject: Subject, asked: Measurement, windows: Windows) -> Tensor:
    return _wind_term_difference(windows, _delivered(subject, asked, windows)).norm(dim=0)


_QUANTITIES: Mapping[Quantity, Callable[[Subject, Measurement, Windows], Tensor]] = {
    "position-error": _position_error,
    "position-response": _position_response,
    "acceleration-error": _acceleration_error,
    "wind-term-error": _wind_term_error,
}


def final_positions(predictor: Predictor, windows: Windows, delivered: DeliveredInputs) -> Tensor:
    """Return the predicted position after the last step, `[3, W]`, m, world frame."""

    def final(windows: Windows, delivered: DeliveredInputs) -> Tensor:
        *_, last = predict(predictor, windows, delivered)
        return last.position[..., 0]

    return by_batch(final, windows, delivered, padded=True)


def _subject(asked: Measurement) -> Subject:
    return Subject.load(quadrotor(asked.recording), asked.subject, asked.seed)


def _delivered(subject: Subject, asked: Measurement, windows: Windows) -> DeliveredInputs:
    return subject.deliver(windows, asked.faults, asked.recording.name)


def _wind_term_difference(windows: Windows, delivered: DeliveredInputs) -> Tensor:
    map_mass = delivered["mass", "predictor.wind_map"]
    truth = wind_term(windows, windows.mass_kg, windows.wind_mps[:, HISTORY])
    return wind_term(windows, map_mass, delivered[WIND].T) - truth


def _true(windows: Windows) -> Calibration:
    return Calibration(windows.mass_kg, windows.thrust_scale)


def _nominal(windows: Windows, calibration: Calibration) -> Tensor:
    lanes = padded_lanes(len(windows))
    wide = Calibration(calibration.mass_kg[lanes], calibration.thrust_scale[lanes])
    return nominal(windows.take(lanes), wide)[:, : len(windows)]
