"""What a recorded flight of the quadrotor adds to its readings: errors, predictions and thrust."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import torch

from faultpath.systems.checks.recording import Recording, Trial, Values, added, trials
from faultpath.trials.attempt import Done
from faultpath.trials.store.signals import Signal
from faultpath_quadrotor.device import arithmetic
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.predictors.kinematic import LinearDrag
from faultpath_quadrotor.system import Quadrotor

_CANDIDATES = 8
"""Equal ones, for the compiled rollout, which works along them."""
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
    ahead = _predicted(recording)
    found: list[tuple[Signal, ...]] = []
    for trial in trials(recording, done, system.control_dt_s):
        thrust = trial.got("action", "vehicle.actuators")[:, :1].astype(np.float32)
        named = [Signal("commanded thrust", "commanded thrust", "N", thrust), *_errors(trial)]
        for horizon, positions in ahead.items():
            said = f"position predicted {horizon * system.control_dt_s:g} s before"
            values = trial.rows(positions).astype(np.float32)
            named.append(Signal(said, "position", "m", values, ("east", "north", "up")))
        found.append(tuple(named))
    return found


def _errors(trial: Trial) -> list[Signal]:
    def told(channel: str, place: str) -> Values:
        return trial.got(channel, f"predictor.{place}")

    true, read = trial.held, trial.recording.got.keys()
    if not {("mass", "predictor.dynamics"), ("mass", "predictor.wind_map")} <= read:
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
    first = nominal(told("mass", "dynamics"), told("thrust_scale", "dynamics")) - nominal(
        mass, scale
    )
    pairs, along = {"nominal": first}, ()
    if ("wind", "predictor.wind_map") in read:
        believed = force(told("wind", "wind_map")) / told("mass", "wind_map")
        second = believed - force(true("true_wind")) / mass
        pairs["combined"] = first + second
        errors = {"predictor: wrong mass and thrust": first, "reconstruction: wrong wind": second}
        along = added(
            "error of the predictor's analytic acceleration along the thrust",
            "m/s^2",
            {
                name: np.einsum("tp,tp->t", error, rotation[:, :, 2])
                for name, error in errors.items()
            },
        )
    sizes = {
        name: np.linalg.norm(error, axis=1, keepdims=True).astype(np.float32)
        for name, error in pairs.items()
    }
    said = "acceleration error"
    return [*(Signal(f"{n} {said}", said, "m/s^2", size) for n, size in sizes.items()), *along]


@arithmetic()
@torch.inference_mode()
def _predicted(recording: Recording) -> Mapping[int, Mapping[int, Values]]:
    """Ask the predictor of every step where the commands that were then flown would lead.

    By horizon in steps and by the step that is spoken of, `[B, 3]`, metres. It is asked again after
    the flight, and answers from what it was told at its step.
    """
    request = recording.asked.get(_MOTION)
    if request is None:
        return {}
    flown = recording.got["action", "vehicle.actuators"]
    horizon = request.commands[0].shape[0]
    found: dict[int, Values] = {}
    for step, query in recording.queries[_MOTION].items():
        if step + horizon not in flown:
            continue
        actions = np.stack([flown[step + h] for h in range(horizon)])
        every = torch.from_numpy(actions).movedim(-1, 1).to(request.commands[0])
        commands = tuple(
            every[:, :, list(part.scenes)][..., None].expand(-1, -1, -1, _CANDIDATES).contiguous()
            for part in request.parts
        )
        asked = replace(request, commands=commands)
        positions = np.full((len(actions[0]), 3), np.nan)
        answer = query.answer(asked)
        for part, rollout in zip(answer.parts, answer.rollouts, strict=True):
            positions[list(part.scenes)] = rollout.positions[:, :, -1, 0].T.double().numpy()
        found[step + horizon] = positions
    return {horizon: found} if found else {}
