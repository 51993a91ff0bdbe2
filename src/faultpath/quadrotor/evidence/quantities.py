"""The quantities of a measurement, each a number a window."""

from collections.abc import Callable, Mapping

import torch
from torch import Tensor

from faultpath.errors import UserError
from faultpath.evidence import Measured, Measurement, Quantity
from faultpath.quadrotor.evidence.compensation import nominal, wind_term
from faultpath.quadrotor.evidence.inputs import Subject, Told
from faultpath.quadrotor.evidence.recording import Recorded, quadrotor
from faultpath.quadrotor.predictors import Calibration, Predictor
from faultpath.quadrotor.state import padded_lanes
from faultpath.quadrotor.training.quality_predictors import BATCH
from faultpath.quadrotor.training.replay import predict
from faultpath.quadrotor.training.windows import HISTORY, Windows


@torch.inference_mode()
def measured(measurement: Measurement, recorded: Recorded) -> Measured:
    """Measure on every window; `UserError` where the measurement does not fit the system.

    A window's number does not depend on the windows beside it, to the bit, unless a fault on the
    history code exchanges them.
    """
    system = quadrotor(measurement.recording)
    subject = Subject.load(system, measurement.subject, measurement.seed)
    values = _QUANTITIES[measurement.quantity](subject, measurement, recorded.windows)
    return Measured(recorded.scenes, recorded.steps, values.double().numpy())


def _position_error(subject: Subject, asked: Measurement, windows: Windows) -> Tensor:
    told = subject.tell(windows, asked.faults, asked.recording.name)
    return (final_positions(subject.predictor, windows, told) - windows.position[:, -1]).norm(dim=0)


def _position_response(subject: Subject, asked: Measurement, windows: Windows) -> Tensor:
    correct, struck = (
        final_positions(
            subject.predictor, windows, subject.tell(windows, faults, asked.recording.name)
        )
        for faults in ((), asked.faults)
    )
    return (struck - correct).norm(dim=0)


def _acceleration_error(subject: Subject, asked: Measurement, windows: Windows) -> Tensor:
    told = _told_wind(subject, asked, windows)
    supplied = Calibration(
        told.supplied["mass", "predictor.dynamics"],
        told.supplied["thrust_scale", "predictor.dynamics"],
    )
    return (
        (_nominal(windows, supplied) - _nominal(windows, _true(windows)))
        + _wind_term_difference(windows, told)
    ).norm(dim=0)


def _wind_term_error(subject: Subject, asked: Measurement, windows: Windows) -> Tensor:
    return _wind_term_difference(windows, _told_wind(subject, asked, windows)).norm(dim=0)


_QUANTITIES: Mapping[Quantity, Callable[[Subject, Measurement, Windows], Tensor]] = {
    "position-error": _position_error,
    "position-response": _position_response,
    "acceleration-error": _acceleration_error,
    "wind-term-error": _wind_term_error,
}


def final_positions(predictor: Predictor, windows: Windows, told: Told) -> Tensor:
    """Return the predicted position after the last step, `[3, W]`, m, world frame."""
    found: list[Tensor] = []
    for index in padded_lanes(len(windows)).split(BATCH):
        *_, last = predict(
            predictor,
            windows.take(index),
            {tap: value[index] for tap, value in told.supplied.items()},
            None if told.wind_mps is None else told.wind_mps[:, index],
            None if told.code is None else told.code[:, index],
        )
        found.append(last.position[..., 0])
    return torch.cat(found, 1)[:, : len(windows)]


def _told_wind(subject: Subject, asked: Measurement, windows: Windows) -> Told:
    if not {"dynamics", "wind_map"} <= subject.predictor.reads:
        raise UserError(
            f"the predictor of {asked.subject!r} has no analytic dynamics with a wind input, so "
            f"{asked.quantity} does not exist for it: measure a variant with a wind input"
        )
    return subject.tell(windows, asked.faults, asked.recording.name)


def _wind_term_difference(windows: Windows, told: Told) -> Tensor:
    assert told.wind_mps is not None
    supplied = told.supplied["mass", "predictor.wind_map"]
    truth = wind_term(windows, windows.mass_kg, windows.wind_mps[:, HISTORY])
    return wind_term(windows, supplied, told.wind_mps) - truth


def _true(windows: Windows) -> Calibration:
    return Calibration(windows.mass_kg, windows.thrust_scale)


def _nominal(windows: Windows, calibration: Calibration) -> Tensor:
    lanes = padded_lanes(len(windows))
    wide = Calibration(calibration.mass_kg[lanes], calibration.thrust_scale[lanes])
    return nominal(windows.take(lanes), wide)[:, : len(windows)]
