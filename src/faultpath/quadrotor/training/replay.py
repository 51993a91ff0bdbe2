"""A predictor on recorded windows: what it would be told at the present, and what it predicts.

Training, validation and probes all come here, so a predictor is fitted to exactly what the closed
loop gives it.
"""

from collections.abc import Iterator, Mapping

import torch
from torch import Tensor

from faultpath.quadrotor.predictors import (
    Calibration,
    History,
    Physics,
    Predictor,
    PredictorInputs,
)
from faultpath.quadrotor.rollout import unroll
from faultpath.quadrotor.state import State
from faultpath.quadrotor.training.windows import HISTORY, Windows

Supplied = Mapping[tuple[str, str], Tensor]
"""Calibration that each tap delivers, `[W]`, by channel and consumer."""


def correct(predictor: Predictor, windows: Windows) -> Supplied:
    """Return the true calibration at every place at which `predictor` reads it."""
    values = {"mass": windows.mass_kg, "thrust_scale": windows.thrust_scale}
    return {
        (channel, f"predictor.{place}"): value
        for channel, value in values.items()
        for place in predictor.reads
    }


def predict(
    predictor: Predictor,
    windows: Windows,
    supplied: Supplied,
    wind_mps: Tensor | None = None,
    code: Tensor | None = None,
) -> Iterator[State]:
    """Yield the predicted states 13 to 32 of every window, batch `[W, 1]`.

    `wind_mps` `[3, W]` replaces the true wind of the present, which is held over the horizon;
    `code` `[32, W]` replaces the history code.
    """
    if code is None:
        code = predictor.encode(history(predictor, windows, supplied))
    wind = windows.wind_mps[:, HISTORY] if wind_mps is None else wind_mps
    inputs = PredictorInputs(
        state=_column(windows.state(HISTORY)),
        trim=_calibration(supplied, "trim"),
        dynamics=_calibration(supplied, "dynamics"),
        wind_map_mass_kg=_at(supplied, "mass", "wind_map"),
        wind_mps=wind[..., None],
        physics=_physics(windows) if "physics" in predictor.reads else None,
        thrust_mass_kg=_at(supplied, "mass", "normalise_thrust"),
        conditioning=_calibration(supplied, "features"),
        code=None if code is None else code[..., None],
    )
    commands = windows.command[:, HISTORY:].movedim(1, 0)[..., None]
    return unroll(predictor, inputs, commands)


def history(predictor: Predictor, windows: Windows, supplied: Supplied) -> History:
    """Return the recorded history of every window as `predictor` is told it, batch `[W]`."""
    past = slice(0, HISTORY)
    features = _calibration(supplied, "features") if "features" in predictor.reads else None
    return History(
        velocity_mps=windows.velocity[:, past],
        rotation=windows.rotation[:, :, past],
        rate_radps=windows.rate[:, past],
        commands=windows.command[:, past],
        mass_kg=supplied.get(("mass", "predictor.history"), windows.mass_kg),
        conditioning=features and features.squeeze(),
    )


def _at(supplied: Supplied, channel: str, place: str) -> Tensor:
    """Return what a place gets, `[W, 1]`; where it does not read, a hole that would show."""
    value = supplied.get((channel, f"predictor.{place}"))
    if value is None:
        value = torch.full_like(next(iter(supplied.values())), torch.nan)
    return value[:, None]


def _calibration(supplied: Supplied, place: str) -> Calibration:
    return Calibration(_at(supplied, "mass", place), _at(supplied, "thrust_scale", place))


def _column(state: State) -> State:
    """Add the candidate axis."""
    return State(
        state.position[..., None],
        state.velocity[..., None],
        state.rotation[..., None],
        state.rate[..., None],
    )


def _physics(windows: Windows) -> Physics:
    return Physics(
        inertia_kgm2=windows.inertia_kgm2[..., None],
        torque_scale=windows.torque_scale[..., None],
        motor_time_constant_s=windows.motor_time_constant_s[..., None],
        drag_kgps=windows.drag_kgps[..., None],
        collective_thrust_n=windows.motor_thrust_n[HISTORY][..., None],
    )
