"""The plant, compiled: all steps of a control interval in one call, contact checks among them."""

import ctypes
import math
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from faultpath_quadrotor.native.kernel_args import Block, Lent, as_kernel_argument, fields
from faultpath_quadrotor.native.library import Kernels
from faultpath_quadrotor.vehicle import (
    COLLECTIVE_MAX_N,
    GRAVITY_MPS2,
    MOTOR_THRUST_MAX_N,
    RATE_GAIN_PER_S,
    RATE_LIMIT_RADPS,
)

_BODY = {"position": (3,), "velocity": (3,), "rotation": (3, 3), "rate": (3,), "thrusts": (4,)}
"""The parts of `Body` in `plant.hpp`, and the shape of each in a lane."""
_ROWS = tuple(math.prod(shape) for shape in _BODY.values())


class _Law(Block):
    """`Law` of `plant.hpp`."""

    _fields_ = (
        *fields(ctypes.c_double, "dt gravity_kick"),
        *fields(ctypes.c_double * 3, "gain rate_limit"),
        *fields(ctypes.c_double, "collective_limit motor_limit"),
    )


class _Before(Block):
    """`Before` of `plant.cpp`."""

    _fields_ = tuple((name, ctypes.c_void_p) for name in _BODY)


_STANDING = {
    "running": torch.bool,
    "crashed": torch.bool,
    "time_s": torch.float64,
    "goal_distance": torch.float64,
    "min_clearance": torch.float64,
}
_AIRFRAME = 15
"""Rows of `Airframe` in `plant.hpp`."""
_SOLID = 10
"""Rows of a prism in `plant_contact.hpp`."""


class _Trial(Block):
    """`Trial` of `plant_contact.hpp`."""

    _fields_ = (
        ("solids", ctypes.c_void_p),
        ("count", ctypes.c_int64),
        ("goal", ctypes.c_void_p),
        ("radius", ctypes.c_double),
        *fields(ctypes.c_int64, "every made"),
        ("per_second", ctypes.c_double),
        *((name, ctypes.c_void_p) for name in _STANDING),
    )


@dataclass(frozen=True)
class Watched:
    """Trials that `CompiledPlant.fly` brings up to date, and their number of lanes."""

    trial: _Trial
    lanes: int


def watch(
    solids: Tensor,
    goal: Tensor,
    standing: Sequence[Tensor],
    *,
    radius_m: float,
    every: int,
    steps: int,
    rate_hz: int,
) -> Watched:
    """Return the trials whose `standing` `CompiledPlant.fly` is to bring up to date.

    Args:
        solids: Prisms that may be touched, `[K, 10, L]`, rows as `Solid` of `plant_contact.hpp`.
        goal: Where trials should end, `[3, L]`, m.
        standing: Running, crashed, time, distance to the goal and least clearance, `[L]` each;
            written to.
        radius_m: The vehicle's radius.
        every: Plant steps between two looks.
        steps: Plant steps before the call.
        rate_hz: Plant steps a second.

    Raises:
        ValueError: `every` is not positive.
    """
    if every < 1:
        raise ValueError(f"contact is looked for every so many steps, not every {every}")
    lanes = goal.shape[-1]
    trial = _Trial(
        as_kernel_argument("solids", solids, len(solids), _SOLID, lanes, dtype=torch.float64),
        len(solids),
        as_kernel_argument("goal", goal, 3, lanes, dtype=torch.float64),
        *(radius_m, every, steps, rate_hz),
        *(
            as_kernel_argument(name, value, lanes, dtype=dtype)
            for (name, dtype), value in zip(_STANDING.items(), standing, strict=True)
        ),
    )
    return Watched(trial, lanes)


class CompiledPlant:
    """Flies one batch of vehicles in float64 on the CPU."""

    def __init__(self, kernels: Kernels, airframes: Tensor, dt_s: float) -> None:
        """Take the vehicles: `airframes` `[15, L]`, rows as `Airframe` of `plant.hpp`."""
        self._kernels = kernels
        lanes = airframes.shape[-1]
        whole = airframes.contiguous()
        self._airframes = as_kernel_argument(
            "airframes", whole, _AIRFRAME, lanes, dtype=torch.float64
        )
        gravity_kick = -GRAVITY_MPS2 * 0.5 * dt_s
        limits = (RATE_GAIN_PER_S, RATE_LIMIT_RADPS, COLLECTIVE_MAX_N, MOTOR_THRUST_MAX_N)
        self._law = _Law(dt_s, gravity_kick, *limits)

    def fly(
        self,
        before: Sequence[Tensor],
        command: Tensor,
        winds: Tensor,
        watched: Watched | None = None,
    ) -> tuple[Tensor, ...]:
        """Return the parts in `before` after one step for each of `winds`.

        Args:
            before: Position, velocity and rate `[3, L]`, rotation `[3, 3, L]` and motor thrusts
                `[4, L]`, in the order of `Body` in `plant.hpp`.
            command: `[4, L]`, of any precision; held.
            winds: `[n, 3, L]`, world frame, m/s.
            watched: From `watch`, for contact checks between the steps.

        Raises:
            RuntimeError: A tensor cannot be expanded to the lanes.
            ValueError: It is not on the CPU, or other trials are watched.
        """
        lanes = self._airframes.tensor.shape[1]
        if watched is not None and watched.lanes != lanes:
            raise ValueError(f"{watched.lanes} trials are watched in {lanes} lanes")
        ready = [
            _ready(name, part, *shape, lanes)
            for (name, shape), part in zip(_BODY.items(), before, strict=True)
        ]
        ends = torch.empty(sum(_ROWS), lanes, dtype=torch.float64)
        self._kernels.call(
            "faultpath_fly",
            *(self._law, self._airframes, _Before(*ready)),
            _ready("command", command, 4, lanes),
            _ready("winds", winds, len(winds), 3, lanes),
            *(len(winds), lanes),
            None if watched is None else watched.trial,
            as_kernel_argument("ends", ends, sum(_ROWS), lanes, dtype=torch.float64),
        )
        parts = zip(ends.split(_ROWS), _BODY.values(), strict=True)
        return tuple(part.view(*shape, lanes) for part, shape in parts)


def _ready(name: str, value: Tensor, *shape: int) -> Lent:
    if value.shape != shape:
        value = value.expand(shape)
    return as_kernel_argument(name, value.double().contiguous(), *shape, dtype=torch.float64)
