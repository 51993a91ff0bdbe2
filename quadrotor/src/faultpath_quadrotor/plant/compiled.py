"""The plant, compiled: all steps of a control interval in one call, contact checks among them."""

import ctypes
import math
from dataclasses import replace

import torch
from torch import Tensor

from faultpath_quadrotor.native.kernel_args import Block, Lent, fields, lend, output
from faultpath_quadrotor.native.library import Kernels
from faultpath_quadrotor.plant.protocol import CONTACT_EVERY, PlantState, Standing
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import (
    COLLECTIVE_MAX_N,
    COLLISION_RADIUS_M,
    GRAVITY_MPS2,
    MOTOR_THRUST_MAX_N,
    PLANT_RATE_HZ,
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
    "terminal_distance_m": torch.float64,
    "min_clearance_m": torch.float64,
}
"""Fields of `TrialProgress` that contact checks change, in the order of `Trial`."""
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


class CompiledPlant:
    """Flies one batch of vehicles in float64 on the CPU."""

    def __init__(self, kernels: Kernels, airframes: Tensor, dt_s: float) -> None:
        """Take the vehicles: `airframes` `[15, L]`, rows as `Airframe` of `plant.hpp`."""
        self._kernels = kernels
        lanes = airframes.shape[-1]
        self._airframes = lend("airframes", airframes, _AIRFRAME, lanes, dtype=torch.float64)
        gravity_kick = -GRAVITY_MPS2 * 0.5 * dt_s
        limits = (RATE_GAIN_PER_S, RATE_LIMIT_RADPS, COLLECTIVE_MAX_N, MOTOR_THRUST_MAX_N)
        self._law = _Law(dt_s, gravity_kick, *limits)

    def advance(
        self, plant_state: PlantState, command: Tensor, winds: Tensor, trial: _Trial | None = None
    ) -> PlantState:
        """Advance one step for each of `winds`; see `Plant.advance`. Batches may be broadcast."""
        lanes = self._airframes.tensor.shape[1]
        before = zip(_BODY.items(), plant_state.parts, strict=True)
        ends = output(sum(_ROWS), lanes, dtype=torch.float64)
        self._kernels.call(
            "faultpath_fly",
            *(self._law, self._airframes),
            _Before(*(_ready(name, part, *shape, lanes) for (name, shape), part in before)),
            _ready("command", command, 4, lanes),
            _ready("winds", winds, len(winds), 3, lanes),
            *(len(winds), lanes, trial, ends),
        )
        parts = zip(ends.tensor.split(_ROWS), _BODY.values(), strict=True)
        *state, thrusts = (part.view(*shape, lanes) for part, shape in parts)
        return PlantState(State(*state), thrusts)

    def fly(
        self, plant_state: PlantState, command: Tensor, winds: Tensor, standing: Standing
    ) -> tuple[PlantState, Standing]:
        """Advance with contact checks between the steps; see `Plant.fly`."""
        lanes, contact, progress = (
            self._airframes.tensor.shape[1],
            standing.contact,
            standing.progress,
        )
        ends = {  # copies, which the kernel changes
            name: lend(name, getattr(progress, name).clone(), lanes, dtype=dtype)
            for name, dtype in _STANDING.items()
        }
        trial = _Trial(
            lend("solids", contact.solids, len(contact.solids), _SOLID, lanes, dtype=torch.float64),
            len(contact.solids),
            lend("goal", contact.goal, 3, lanes, dtype=torch.float64),
            *(COLLISION_RADIUS_M, CONTACT_EVERY, standing.steps, PLANT_RATE_HZ),
            *ends.values(),
        )
        flown = self.advance(plant_state, command, winds, trial)
        progress = replace(progress, **{name: lent.tensor for name, lent in ends.items()})
        return flown, Standing(contact, progress, standing.steps + len(winds))


def _ready(name: str, value: Tensor, *shape: int) -> Lent:
    return lend(name, value.expand(shape).double(), *shape, dtype=torch.float64)
