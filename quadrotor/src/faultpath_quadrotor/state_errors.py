"""What a fault of a sensor does to a filter's estimates, recorded to be delivered elsewhere."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from typing_extensions import override

from faultpath.core.errors import UserError
from faultpath.faults import Address, AnyFault, Record, resolve
from faultpath.loop import Observer, Reading, Tap
from faultpath.trials import Arm
from faultpath.trials.attempt import taps_of
from faultpath_quadrotor.estimators import ErrorStateFilter
from faultpath_quadrotor.estimators.eskf import AT, Filtered
from faultpath_quadrotor.estimators.protocol import STATE_SOURCES
from faultpath_quadrotor.estimators.sensors import SENSORS
from faultpath_quadrotor.system import Quadrotor

TURNING = ("attitude",)
"""Channels whose errors are rotations; see `faultpath.faults.encode_record`."""

_FILTER, _PRESENT = f"{ErrorStateFilter.name}.{AT}", "predictor.initial_state"


class _Seen(Observer):
    """Keeps what came to the filter before any fault, and what it said of the state."""

    def __init__(self) -> None:
        self.steps: list[dict[str, torch.Tensor]] = []

    @override
    def delivered(self, tap: Tap, reading: Reading, step: int, got: Any) -> None:
        if tap.consumer in (_FILTER, _PRESENT):
            self.steps += [{} for _ in range(step + 1 - len(self.steps))]
            self.steps[step][tap.channel] = reading.value


def state_errors(
    system: Quadrotor, variant: str, scenes: Sequence[str], seed: int, faults: Sequence[AnyFault]
) -> Record:
    """Fly scenes under faults of the sensors, and return the errors of the filter by channel.

    An error is the filter's estimate beside what the same filter would have said at that moment of
    the same flight had no sensor been faulty: its usual errors are not part of it. A scene's record
    ends with its flight. Deliver it with the fault `state:recorded=FILE@CONSUMER`.

    Raises `UserError` for a variant whose state no filter of ours estimates.
    """
    filter_ = system.setups[variant].load_estimator(seed, system.options)
    if not isinstance(filter_, ErrorStateFilter):
        raise UserError(
            f"variant '{variant}' has no filter whose errors could be recorded: choose "
            "--estimator eskf"
        )
    seen = _Seen()
    found = resolve(faults, system.interface, system.variants[variant].consumers)
    arm = Arm(variant=variant, faults=found, seed=seed)
    outcomes = system.run(variant, scenes, taps_of(system, arm, scenes, observer=seen), seed)
    apart = _apart(filter_, seen.steps)
    ends = [max(1, round(outcome.time_s / system.control_dt_s)) for outcome in outcomes]
    return {
        Address(channel, scene, seed): errors[:end, index]
        for channel, errors in apart.items()
        for index, (scene, end) in enumerate(zip(scenes, ends, strict=True))
    }


@torch.inference_mode()
def _apart(
    filter_: ErrorStateFilter, steps: Sequence[dict[str, torch.Tensor]]
) -> dict[str, np.ndarray]:
    """Return estimates beside those from readings without a fault, `[T, B, ...]` by channel."""
    past: Filtered | None = None
    apart: dict[str, list[torch.Tensor]] = {channel: [] for channel in STATE_SOURCES}
    for step, held in enumerate(steps):
        read = {name: held[name].movedim(0, -1).contiguous() for name in SENSORS}
        past = filter_.begun(read) if past is None else filter_.taken(past, read, step)
        for channel, clean in filter_.said(past, read).items():
            known, said = clean.movedim(-1, 0), held[channel]
            turning = channel in TURNING
            apart[channel].append(known.transpose(1, 2) @ said if turning else said - known)
    return {channel: torch.stack(each).float().numpy() for channel, each in apart.items()}
