"""Memory of the executed flight for learned predictors: its last intervals, encoded."""

from dataclasses import dataclass

import torch
from torch import Tensor

from faultpath.loop import Batch, Inputs, Memory, Module, Outputs
from faultpath_quadrotor.batching import lanes_of, scenes_first
from faultpath_quadrotor.predictors import Predictor
from faultpath_quadrotor.predictors.predictor_inputs import Take, history, ports, taking

STEPS = 12  # paper, Section IV-A

MOTION = ("velocity", "attitude", "body_rate")


@dataclass(frozen=True)
class _Past:
    """The last intervals of every lane, as delivered when they were new."""

    lanes: Tensor
    count: int
    intervals: tuple[tuple[dict[str, Tensor], Tensor], ...] = ()
    """Motion at the start of each, and the command executed over it."""
    latest: dict[str, Tensor] | None = None


class HistoryEncoder(Module):
    """Encodes the last 12 intervals of every lane, once a step.

    Before the flight the vehicle hovered where it is first seen, under the command that was
    executed then. The supplied mass normalises the whole record anew at each step.
    """

    name, writes = "predictor", ("history_encoding",)

    def __init__(self, predictor: Predictor, device: torch.device) -> None:
        self._predictor = predictor
        self._device = device
        places = {"history", "features"} & predictor.reads
        reads = ports(places)
        self.reads_past = frozenset(port for port in reads if port.channel == "action")
        self.reads = reads - self.reads_past

    def begin(self, batch: Batch) -> Memory:
        """Return a memory without an interval."""
        return _Past(lanes_of(batch, self._device), len(batch.scenes))

    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Take the step's readings in and return the code `[B, 32]`."""
        past: _Past = memory
        take = taking(inputs, past.lanes)
        record = _recall(past, take)
        motions, commands = zip(*record.intervals, strict=True)

        def recalled(channel: str, place: str) -> Tensor:
            if channel == "mass" or place != "history":
                return take(channel, place)
            if channel == "action":
                return torch.stack(commands, 1)
            return torch.stack(
                [motion[channel] for motion in motions], motions[0][channel].ndim - 1
            )

        code = self._predictor.encode(history(self._predictor.reads, recalled))
        assert code is not None
        return {"history_encoding": scenes_first(code, past.count)}, record


def _recall(past: _Past, take: Take) -> _Past:
    motion = {name: take(name, "history") for name in MOTION}
    command = take("action", "history")
    if past.latest is None:
        intervals = ((motion, command),) * STEPS
    else:
        intervals = (*past.intervals[1:], (past.latest, command))
    return _Past(past.lanes, past.count, intervals, motion)
