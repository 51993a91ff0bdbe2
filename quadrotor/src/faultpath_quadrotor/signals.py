"""Signals of a recorded flight beside its readings: errors, predictions and thrust."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import torch

from faultpath.plugin.recording import Done, RecordedTrial, Recording, Signal, Values, added, trials
from faultpath_quadrotor.device import arithmetic
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.predictors.kinematic import LinearDrag
from faultpath_quadrotor.system import Quadrotor

_CANDIDATES = 8
"""Identical candidates, since the compiled rollout works along them."""
_MOTION = "predicted_motion"


def quadrotor_signals(
    system: Quadrotor, recording: Recording, done: Done
) -> list[tuple[Signal, ...]]:
    """Return more signals of each scene of a flight of the quadrotor.

    The acceleration errors are those of the paper, with the thrust and the attitude of the flight:
    what a wrong calibration does to the nominal acceleration, and what is left of it after the wind
    that the predictor was given. They exist where the predictor has analytic dynamics and a wind.
    Along the thrust they have a sign, so that it shows whether they cancel (paper, Eq. 2). What a
    learned predictor adds to its analytic dynamics is in none of them.
    """
    predictions = _predicted(recording)
    by_trial: list[tuple[Signal, ...]] = []
    for trial in trials(recording, done, system.control_dt_s):
        thrust = trial.delivered("action", "vehicle.actuators")[:, :1].astype(np.float32)
        signals = [Signal("commanded thrust", "commanded thrust", "N", thrust), *_errors(trial)]
        for horizon, positions in predictions.items():
            name = f"position predicted {horizon * system.control_dt_s:g} s before"
            values = trial.rows(positions).astype(np.float32)
            signals.append(Signal(name, "position", "m", values, ("east", "north", "up")))
        by_trial.append(tuple(signals))
    return by_trial


def _errors(trial: RecordedTrial) -> list[Signal]:
    def delivered(channel: str, place: str) -> Values:
        return trial.delivered(channel, f"predictor.{place}")

    true, reads = trial.source, trial.recording.got.keys()
    if not {("mass", "predictor.dynamics"), ("mass", "predictor.wind_map")} <= reads:
        return []
    drag = LinearDrag(PLATFORM.drag_kgps)
    rotation = true("vehicle.attitude").reshape(-1, 3, 3)

    def force(air: Values) -> Values:
        turned = torch.from_numpy(np.moveaxis(rotation, 0, -1).copy())
        return drag.force(turned, torch.from_numpy(air.T.copy())).numpy().T

    def nominal(mass: Values, scale: Values) -> Values:
        thrust = true("true_physics")[:, 8:9]
        return (rotation[:, :, 2] * scale * thrust + force(-true("vehicle.velocity"))) / mass

    mass, scale = true("vehicle.mass"), true("vehicle.thrust_scale")
    believed = nominal(delivered("mass", "dynamics"), delivered("thrust_scale", "dynamics"))
    calibration_error = believed - nominal(mass, scale)
    errors, along = {"nominal": calibration_error}, ()
    if ("wind", "predictor.wind_map") in reads:
        reconstructed = force(delivered("wind", "wind_map")) / delivered("mass", "wind_map")
        wind_error = reconstructed - force(true("true_wind")) / mass
        errors["combined"] = calibration_error + wind_error
        shares = {
            "predictor: wrong mass and thrust": calibration_error,
            "reconstruction: wrong wind": wind_error,
        }
        along = added(
            "error of the predictor's analytic acceleration along the thrust",
            "m/s^2",
            {
                name: np.einsum("tp,tp->t", share, rotation[:, :, 2])
                for name, share in shares.items()
            },
        )
    quantity = "acceleration error"
    signals = [
        Signal(
            f"{name} {quantity}",
            quantity,
            "m/s^2",
            np.linalg.norm(error, axis=1, keepdims=True).astype(np.float32),
        )
        for name, error in errors.items()
    ]
    return [*signals, *along]


@arithmetic()
@torch.inference_mode()
def _predicted(recording: Recording) -> Mapping[int, Mapping[int, Values]]:
    """Return where the predictor of each step expects the commands then flown to lead.

    Positions `[B, 3]`, metres, by horizon in steps and by the step that they are predicted for. The
    predictor is queried after the flight, and answers from the readings of its step.
    """
    request = recording.requests.get(_MOTION)
    if request is None:
        return {}
    flown = recording.got["action", "vehicle.actuators"]
    horizon = request.commands[0].shape[0]
    by_step: dict[int, Values] = {}
    for step, query in recording.queries[_MOTION].items():
        if step + horizon not in flown:
            continue
        stacked = np.stack([flown[step + h] for h in range(horizon)])
        actions = torch.from_numpy(stacked).movedim(-1, 1).to(request.commands[0])
        commands = tuple(
            actions[:, :, list(chunk.scenes)][..., None]
            .expand(-1, -1, -1, _CANDIDATES)
            .contiguous()
            for chunk in request.chunks
        )
        positions = np.full((len(stacked[0]), 3), np.nan)
        answer = query.answer(replace(request, commands=commands))
        for chunk, rollout in zip(answer.chunks, answer.rollouts, strict=True):
            positions[list(chunk.scenes)] = rollout.positions[:, :, -1, 0].T.double().numpy()
        by_step[step + horizon] = positions
    return {horizon: by_step} if by_step else {}
