"""Errors that sensor faults cause in a filter's estimates, recorded to be delivered elsewhere."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from typing_extensions import override

from faultpath.faults import Address, Fault, Record, resolve
from faultpath.loop import DeliveryListener, Reading, Tap
from faultpath.plugin.recording import taps_of
from faultpath.plugin.system import Treatment, UserError
from faultpath_quadrotor.estimators import ErrorStateFilter
from faultpath_quadrotor.estimators.eskf import AT, Filtered
from faultpath_quadrotor.estimators.protocol import STATE_SOURCES
from faultpath_quadrotor.estimators.sensors import SENSORS
from faultpath_quadrotor.system import Quadrotor

TURNING = ("attitude",)
"""Channels whose errors are rotations; see `faultpath.faults.encode_record`."""

_FILTER, _PRESENT = f"{ErrorStateFilter.name}.{AT}", "predictor.initial_state"


class _Seen(DeliveryListener):
    """Keeps the filter's readings before any fault, and its estimates of the state."""

    def __init__(self) -> None:
        self.steps: list[dict[str, torch.Tensor]] = []

    @override
    def delivered(self, tap: Tap, reading: Reading, step: int, got: Any) -> None:
        if tap.reader in (_FILTER, _PRESENT):
            self.steps += [{} for _ in range(step + 1 - len(self.steps))]
            self.steps[step][tap.channel] = reading.value


def state_errors(
    system: Quadrotor, variant: str, scenes: Sequence[str], seed: int, faults: Sequence[Fault]
) -> Record:
    """Fly scenes under faults of the sensors, and return the errors of the filter by channel.

    An error is the difference between the filter's estimate and the one that the same filter would
    have made at that step of the same flight without faults: its usual errors are not part of it. A
    scene's record ends with its flight. Deliver it with the fault `state:recorded=FILE@READER`.

    Raises `UserError` for a variant whose state no filter of ours estimates.
    """
    filter_ = system.variant_parts[variant].load_estimator(seed, system.options)
    if not isinstance(filter_, ErrorStateFilter):
        raise UserError(
            f"variant '{variant}' has no filter whose errors could be recorded: choose "
            "--estimator eskf"
        )
    readers = system.variants[variant].readers
    treatment = Treatment(
        variant=variant, faults=resolve(faults, system.interface, readers), seed=seed
    )
    observer = _Seen()
    outcomes = system.run(
        variant, scenes, taps_of(system, treatment, scenes, observer=observer), seed
    )
    errors = _errors(filter_, observer.steps)
    ends = [max(1, round(outcome.time_s / system.control_dt_s)) for outcome in outcomes]
    return {
        Address(channel, scene, seed): values[:end, index]
        for channel, values in errors.items()
        for index, (scene, end) in enumerate(zip(scenes, ends, strict=True))
    }


@torch.inference_mode()
def _errors(
    filter_: ErrorStateFilter, steps: Sequence[dict[str, torch.Tensor]]
) -> dict[str, np.ndarray]:
    """Return estimates minus those from readings without a fault, `[T, B, ...]` by channel."""
    past: Filtered | None = None
    errors: dict[str, list[torch.Tensor]] = {channel: [] for channel in STATE_SOURCES}
    for step, values in enumerate(steps):
        readings = {name: values[name].movedim(0, -1).contiguous() for name in SENSORS}
        past = filter_.begun(readings) if past is None else filter_.taken(past, readings, step)
        for channel, clean in filter_.estimates(past, readings).items():
            expected, estimate = clean.movedim(-1, 0), values[channel]
            errors[channel].append(
                expected.transpose(1, 2) @ estimate if channel in TURNING else estimate - expected
            )
    return {channel: torch.stack(series).float().numpy() for channel, series in errors.items()}
