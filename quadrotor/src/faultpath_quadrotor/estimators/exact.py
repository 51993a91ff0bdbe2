"""The exact estimator: faults are put on what it says, behind it."""

from collections.abc import Collection

from torch import Tensor

from faultpath.loop import Inputs, Memory, Outputs
from faultpath_quadrotor.estimators.protocol import SOURCES, Estimator


class ExactEstimator(Estimator):
    """Estimates without error (the paper's): the one module that takes the plant's truth past all
    taps.

    Args:
        besides: Sources that another estimator writes.
    """

    truths = ("vehicle",)

    def __init__(self, besides: Collection[str] = ()) -> None:
        self._names = {name: s for name, s in SOURCES.items() if s not in besides}
        self.writes = tuple(self._names.values())

    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Return the truth, `[B, ...]` each."""
        truth: dict[str, Tensor] = inputs.truth("vehicle")
        return {source: truth[name] for name, source in self._names.items()}, memory
