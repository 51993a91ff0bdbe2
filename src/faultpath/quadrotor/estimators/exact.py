"""The estimator: what the controller knows of the vehicle, and where it has that from."""

from torch import Tensor

from faultpath.loop import Inputs, Memory, Module, Outputs

STATE_SOURCES = {
    "position": "position_estimate",
    "velocity": "velocity_estimate",
    "attitude": "attitude_estimate",
    "body_rate": "body_rate_measurement",
}
CALIBRATION_SOURCES = {"mass": "mass_estimate", "thrust_scale": "thrust_scale_estimate"}


class ExactEstimator(Module):
    """Estimates without error (the paper's): faults are put on what it says, behind it.

    It is the one module that takes the plant's truth past all taps.
    """

    name = "estimator"
    writes = (*CALIBRATION_SOURCES.values(), *STATE_SOURCES.values())
    truths = ("vehicle",)

    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Return the truth, `[B, ...]` each."""
        truth: dict[str, Tensor] = inputs.truth("vehicle")
        sources = CALIBRATION_SOURCES | STATE_SOURCES
        return {source: truth[name] for name, source in sources.items()}, memory
