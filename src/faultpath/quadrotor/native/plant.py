"""The plant, compiled: all steps of a control interval in one call, contact checks among them."""

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from faultpath.quadrotor.native.lending import Lent, lend
from faultpath.quadrotor.native.library import Kernels
from faultpath.quadrotor.scenes.geometry import Geometry
from faultpath.quadrotor.state import State
from faultpath.quadrotor.vehicle import (
    COLLECTIVE_MAX_N,
    COLLISION_RADIUS_M,
    GRAVITY_MPS2,
    MOTOR_THRUST_MAX_N,
    RATE_GAIN_PER_S,
    RATE_LIMIT_RADPS,
)

_ROWS = (3, 3, 9, 3, 4)
"""Rows of `Body` in `plant.hpp`: position, velocity, rotation, rate, thrusts."""


class _Law(ctypes.Structure):
    """`Law` of `plant.hpp`."""

    _fields_ = (
        ("dt", ctypes.c_double),
        ("gravity_kick", ctypes.c_double),
        ("gain", ctypes.c_double * 3),
        ("rate_limit", ctypes.c_double * 3),
        ("collective_limit", ctypes.c_double),
        ("motor_limit", ctypes.c_double),
    )


class _Before(ctypes.Structure):
    """`Before` of `plant.cpp`."""

    _fields_ = tuple(
        (name, ctypes.c_void_p) for name in ("position", "velocity", "rotation", "rate", "thrust")
    )


_STANDING = (
    ("running", torch.bool),
    ("crashed", torch.bool),
    ("time_s", torch.float64),
    ("goal_distance", torch.float64),
    ("min_clearance", torch.float64),
)
_AIRFRAME = 15
"""Rows of `Airframe` in `plant.hpp`."""
_SOLID = 10
"""Rows of a prism in `plant_contact.hpp`."""


class _Trial(ctypes.Structure):
    """`Trial` of `plant_contact.hpp`."""

    _fields_ = (
        ("solids", ctypes.c_void_p),
        ("count", ctypes.c_int64),
        ("goal", ctypes.c_void_p),
        ("radius", ctypes.c_double),
        ("every", ctypes.c_int64),
        ("made", ctypes.c_int64),
        ("per_second", ctypes.c_double),
        *(
            (name, ctypes.c_void_p)
            for name in ("running", "crashed", "time_s", "goal_distance", "min_clearance")
        ),
    )


@dataclass(frozen=True)
class Watched:
    """What `CompiledPlant.fly` brings up to date, and what it looks at for that."""

    trial: _Trial
    held: tuple[Lent, ...]
    """The kernel holds addresses only."""
    lanes: int


class CompiledContact:
    """What there is to touch, and where each lane's trial should end."""

    def __init__(self, geometry: Geometry, goal: Tensor, every: int, rate_hz: int) -> None:
        """Prepare checks `every` so many plant steps of `rate_hz`; `goal` is `[3, L]`, m.

        Raises:
            ValueError: `every` is not positive, or the prisms and goals are not of as many lanes.
        """
        if every < 1:
            raise ValueError(f"contact is looked for every so many steps, not every {every}")
        count, lanes = geometry.sign.shape
        if goal.shape != (3, lanes):
            raise ValueError(f"{lanes} scenes have goals of the shape {list(goal.shape)}")
        rows = (
            geometry.along_x[:1],  # the cosine of each prism's yaw
            geometry.along_y[:1],  # and its sine
            geometry.offset,
            geometry.half,
            geometry.rounding[None],
            geometry.sign[None],
        )
        self._solids = torch.cat(rows).transpose(0, 1).contiguous()
        self._goal = goal.contiguous()
        self._shape = (count, _SOLID, lanes)
        self._every, self._rate_hz = every, rate_hz

    def watch(self, made: int, standing: Sequence[Tensor]) -> Watched:
        """Return what lets `CompiledPlant.fly` bring the trials' `standing` up to date.

        Args:
            made: Plant steps before the call.
            standing: Running, crashed, time, distance to the goal and least clearance, `[L]` each;
                written to.

        Raises:
            ValueError: A tensor is not what the kernel takes; see `lend`.
        """
        *_, lanes = self._shape
        solids = lend("solids", self._solids, *self._shape, dtype=torch.float64)
        goal = lend("goal", self._goal, 3, lanes, dtype=torch.float64)
        stand = tuple(
            lend(name, value, lanes, dtype=dtype)
            for (name, dtype), value in zip(_STANDING, standing, strict=True)
        )
        trial = _Trial(
            solids.address,
            len(self._solids),
            goal.address,
            COLLISION_RADIUS_M,
            self._every,
            made,
            self._rate_hz,
            *(part.address for part in stand),
        )
        return Watched(trial, (solids, goal, *stand), lanes)


class CompiledPlant:
    """Flies one batch of vehicles in float64 on the CPU."""

    def __init__(self, kernels: Kernels, airframes: Tensor, dt_s: float) -> None:
        """Take what the vehicles are: `airframes` `[15, L]`, rows as `Airframe` of `plant.hpp`."""
        self._kernels = kernels
        lanes = airframes.shape[-1]
        whole = airframes.contiguous()
        self._airframes = lend("airframes", whole, _AIRFRAME, lanes, dtype=torch.float64)
        self._law = _Law(
            dt=dt_s,
            gravity_kick=-GRAVITY_MPS2 * 0.5 * dt_s,
            gain=RATE_GAIN_PER_S,
            rate_limit=RATE_LIMIT_RADPS,
            collective_limit=COLLECTIVE_MAX_N,
            motor_limit=MOTOR_THRUST_MAX_N,
        )

    def fly(
        self,
        state: State,
        thrusts: Tensor,
        command: Tensor,
        winds: Tensor,
        watched: Watched | None = None,
    ) -> tuple[State, Tensor]:
        """Return state and motor thrusts after one step for each of `winds`.

        Args:
            state: Batch `[L]`, float64.
            thrusts: `[4, L]`, N.
            command: `[4, L]`, of any precision; held.
            winds: `[n, 3, L]`, world frame, m/s.
            watched: From `CompiledContact.watch`, for contact checks between the steps.

        Raises:
            RuntimeError: A tensor cannot be expanded to the lanes.
            ValueError: It is not on the CPU (see `lend`), or other trials are watched.
        """
        lanes = self._airframes.tensor.shape[1]
        if watched is not None and watched.lanes != lanes:
            raise ValueError(f"{watched.lanes} trials are watched in {lanes} lanes")
        before = (
            _ready("position", state.position, 3, lanes),
            _ready("velocity", state.velocity, 3, lanes),
            _ready("rotation", state.rotation, 3, 3, lanes),
            _ready("rate", state.rate, 3, lanes),
            _ready("thrusts", thrusts, 4, lanes),
        )
        ends = torch.empty(sum(_ROWS), lanes, dtype=torch.float64)
        self._kernels.call(
            "faultpath_fly",
            ctypes.byref(self._law),
            self._airframes,
            ctypes.byref(_Before(*(part.address for part in before))),
            _ready("command", command, 4, lanes),
            _ready("winds", winds, len(winds), 3, lanes),
            *(len(winds), lanes),
            None if watched is None else ctypes.byref(watched.trial),
            lend("ends", ends, sum(_ROWS), lanes, dtype=torch.float64),
        )
        position, velocity, rotation, rate, thrusts = ends.split(_ROWS)
        return State(position, velocity, rotation.view(3, 3, lanes), rate), thrusts


def _ready(name: str, value: Tensor, *shape: int) -> Lent:
    """Return `value` as the kernel reads it: of this shape, double, contiguous."""
    if value.shape != shape:
        value = value.expand(shape)
    return lend(name, value.double().contiguous(), *shape, dtype=torch.float64)
