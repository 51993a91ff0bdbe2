"""Recorded windows for fitting: a predictor rolled out from their presents, with gradients.

`playback` steps the modules through a window's history, as a flight does. A fit needs one history
code of the thirteen that they compute on the way, so here the predictor is called at the present
alone. What it gets comes from the same map (`predictors.places`), and the same code encodes
histories and rolls out.
"""

from collections.abc import Iterator, Mapping

from torch import Tensor

from faultpath_quadrotor.predictors import Predictor
from faultpath_quadrotor.predictors.places import Take, history, predictor_inputs
from faultpath_quadrotor.predictors.rollout import unroll
from faultpath_quadrotor.state import State
from faultpath_quadrotor.training.windows import HISTORY, Windows

DeliveredInputs = Mapping[tuple[str, str], Tensor]
"""The calibration that taps delivered to windows, `[W]`, by channel and consumer; it is held over
history and horizon."""


def correct(model: Predictor, windows: Windows) -> DeliveredInputs:
    """Return the true calibration at every place at which a model reads it."""
    return {
        (channel, consumer): value
        for channel, value in windows.calibration.items()
        for consumer in model.consumers()
    }


def predict(predictor: Predictor, windows: Windows, delivered: DeliveredInputs) -> Iterator[State]:
    """Yield the predicted states 13 to 32 of every window, batch `[W, 1]`.

    The true wind of the present is held over the horizon.
    """
    past = _taking(windows, delivered, slice(0, HISTORY))
    now = _taking(windows, delivered, HISTORY)

    def take(channel: str, place: str) -> Tensor:
        if channel != "history_code":
            return now(channel, place)
        code = predictor.encode(history(predictor.reads, past))
        assert code is not None
        return code

    inputs = predictor_inputs(predictor.reads, take)
    commands = windows.command[:, HISTORY:].movedim(1, 0)[..., None]
    return unroll(predictor, inputs, commands)


def _taking(windows: Windows, delivered: DeliveredInputs, k: int | slice) -> Take:
    def take(channel: str, place: str) -> Tensor:
        if channel in windows.calibration:
            return delivered[channel, f"predictor.{place}"]
        if channel == "physics":
            return windows.physics(HISTORY).reading()
        recorded = {
            "position": windows.position,
            "velocity": windows.velocity,
            "attitude": windows.rotation,
            "body_rate": windows.rate,
            "action": windows.command,
            "wind": windows.wind_mps,
        }
        return recorded[channel][..., k, :]

    return take
