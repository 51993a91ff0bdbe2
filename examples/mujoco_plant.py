"""A plant of one's own for the quadrotor: MuJoCo, which shares no equation of motion with ours.

    faultpath audit quadrotor --plant examples/mujoco_plant.py:create

It flies the same vehicle (extra `[mujoco]`): what an audit finds on it does not depend on how the
reference plant is written, and a test holds the two together. MuJoCo integrates the free body, the
motors' lag and the drag. Rate loop and mixer are written again, from force balance at the motors'
places. MuJoCo's own wind is another fluid model and stays off, and so do its contacts: what touches
what is the world's affair.
"""

# MuJoCo is a compiled module whose names pyright cannot see.
# pyright: reportAttributeAccessIssue=false, reportUnknownMemberType=false
# pyright: reportUnknownVariableType=false

from __future__ import annotations

import math
from dataclasses import fields

import mujoco
import numpy as np
import torch
from faultpath_quadrotor.plant.protocol import Plant, PlantState, Vehicle
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import (
    ARM_LENGTH_M,
    COLLECTIVE_MAX_N,
    GRAVITY_MPS2,
    MOTOR_THRUST_MAX_N,
    PLANT_DT_S,
    RATE_GAIN_PER_S,
    RATE_LIMIT_RADPS,
    TORQUE_COEFFICIENT_M,
    VehicleParameters,
)
from mujoco import rollout
from numpy.typing import ArrayLike, NDArray
from torch import Tensor

Array = NDArray[np.float64]

_BEARINGS_DEG = (45.0, 135.0, 225.0, 315.0)  # front left, rear left, rear right, front right
_SPINS = (1.0, -1.0, 1.0, -1.0)
_DRAGS = 3
"""Actuators after the motors: drag along x, y and z."""

_POSITION, _QUATERNION = slice(1, 4), slice(4, 8)
_VELOCITY, _RATE, _THRUSTS = slice(8, 11), slice(11, 14), slice(14, 18)
"""Where a vehicle's parts stand in MuJoCo's state, after the time."""
_REST = np.eye(18)[_QUATERNION.start]


def _wrenches() -> Array:
    rows = []
    for bearing, spin in zip(np.radians(_BEARINGS_DEG), _SPINS, strict=True):
        place = ARM_LENGTH_M * np.array([math.cos(bearing), math.sin(bearing), 0.0])
        torque = np.cross(place, [0.0, 0.0, 1.0])
        torque[2] += spin * TORQUE_COEFFICIENT_M
        rows.append([0.0, 0.0, 1.0, *torque])
    return np.array(rows)


_MIX = np.linalg.inv(_wrenches()[:, 2:].T)
"""Thrust of each motor per collective thrust and torque, [4 motors, 4]."""


def _numbers(values: ArrayLike) -> str:
    return " ".join(repr(float(x)) for x in np.atleast_1d(values))


def build_model(vehicle: VehicleParameters) -> mujoco.MjModel:
    """Return the MuJoCo model of one vehicle; actuators: four motors, then drag x, y, z."""
    scale = np.array([vehicle.thrust_scale] * 3 + [vehicle.torque_scale] * 3)
    motors = "".join(
        f'<general site="centre" gear="{_numbers(wrench * scale)}" dyntype="filter" '
        f'dynprm="{vehicle.motor_time_constant_s!r}"/>'
        for wrench in _wrenches()
    )
    drag = "".join(
        f'<velocity site="centre" gear="{_numbers(np.eye(6)[axis])}" kv="{coefficient!r}"/>'
        for axis, coefficient in enumerate(vehicle.drag_kgps)
    )
    return mujoco.MjModel.from_xml_string(f"""
        <mujoco>
          <option timestep="{PLANT_DT_S!r}" gravity="0 0 {-GRAVITY_MPS2!r}" integrator="RK4"/>
          <worldbody>
            <body>
              <freejoint/>
              <inertial pos="0 0 0" mass="{vehicle.mass_kg!r}"
                        diaginertia="{_numbers(vehicle.inertia_kgm2)}"/>
              <site name="centre"/>
            </body>
          </worldbody>
          <actuator>{motors}{drag}</actuator>
        </mujoco>""")


class MujocoPlant(Plant):
    """Vehicles on MuJoCo, a model each, stepped at 500 Hz by its fourth-order Runge-Kutta method.

    Each step is made in the frame of the air, in which drag is plain damping and the wind of the
    step, being constant, leaves no trace. One batch axis, in float64 on the CPU.
    """

    mark = "mujoco"

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        parameters = _parameters(vehicle)
        models = {
            each: build_model(each) for each in set(parameters)
        }  # padded lanes repeat a vehicle
        self._models = [models[each] for each in parameters]
        self._scratch = [mujoco.MjData(self._models[0])]
        self._pool = rollout.Rollout(nthread=0)
        self._inertia = vehicle.inertia_kgm2.numpy().T.copy()

    def advance(self, now: PlantState, command: Tensor, winds: Tensor) -> PlantState:
        """Advance as every plant does; a lane with a number that is none has none from there on."""
        physics = _pack(now)
        asked = command.double().numpy().T
        for wind_mps in winds.double().numpy():
            physics = self._step(physics, asked, wind_mps.T)
        return _unpack(physics)

    def _step(self, physics: Array, asked: Array, wind_mps: Array) -> Array:
        control = np.zeros((len(physics), 1, len(_MIX) + _DRAGS))
        control[:, 0, : len(_MIX)] = self._motor_commands(asked, physics[:, _RATE])
        before = physics.copy()
        before[:, _VELOCITY] -= wind_mps
        lost = ~(np.isfinite(before).all(1) & np.isfinite(control).all((1, 2)))
        before[lost], control[lost] = _REST, 0.0  # MuJoCo would start such a lane again, and log it
        after = np.empty((len(physics), 1, physics.shape[1]))
        self._pool.rollout(
            self._models,
            self._scratch,
            before,
            control,
            control_spec=mujoco.mjtState.mjSTATE_CTRL.value,
            nstep=1,
            state=after,
            sensordata=np.empty((len(physics), 1, 0)),
            skip_checks=True,
        )
        after = after[:, 0]
        after[:, _VELOCITY] += wind_mps
        after[:, _POSITION] += PLANT_DT_S * wind_mps
        after[lost] = np.nan
        return after

    def _motor_commands(self, asked: Array, rate: Array) -> Array:
        limit = np.array(RATE_LIMIT_RADPS)
        error = np.clip(asked[:, 1:], -limit, limit) - rate
        torque = self._inertia * RATE_GAIN_PER_S * error + np.cross(rate, self._inertia * rate)
        collective = np.clip(asked[:, :1], 0.0, COLLECTIVE_MAX_N)
        shares = np.concatenate((collective, torque), axis=1)[:, None] * _MIX
        level = np.clip(shares[..., :3].sum(-1), 0.0, MOTOR_THRUST_MAX_N)
        stroke = shares[..., 3]
        room = np.minimum(level, MOTOR_THRUST_MAX_N - level).min(1, keepdims=True)
        longest = np.abs(stroke).max(1, keepdims=True)
        return level + stroke * np.minimum(1.0, room / np.maximum(longest, 1e-300))


def _parameters(vehicle: Vehicle) -> list[VehicleParameters]:
    columns = {
        field.name: getattr(vehicle, field.name).numpy().T.tolist() for field in fields(vehicle)
    }
    rows = zip(*columns.values(), strict=True)
    return [VehicleParameters(**dict(zip(columns, row, strict=True))) for row in rows]


def _pack(now: PlantState) -> Array:
    state = now.state
    physics = np.zeros((now.thrusts.shape[-1], len(_REST)))
    physics[:, _POSITION] = state.position.numpy().T
    physics[:, _VELOCITY] = state.velocity.numpy().T
    physics[:, _RATE] = state.rate.numpy().T
    physics[:, _THRUSTS] = now.thrusts.numpy().T
    matrices = state.rotation.flatten(0, 1).numpy().T.copy()
    for row, matrix in zip(physics, matrices, strict=True):
        mujoco.mju_mat2Quat(row[_QUATERNION], matrix)
    return physics


def _unpack(physics: Array) -> PlantState:
    matrices = np.empty((len(physics), 9))
    for row, matrix in zip(physics, matrices, strict=True):
        mujoco.mju_quat2Mat(matrix, row[_QUATERNION])

    def lanes(values: Array) -> Tensor:
        return torch.from_numpy(np.ascontiguousarray(values.T))

    state = State(
        lanes(physics[:, _POSITION]),
        lanes(physics[:, _VELOCITY]),
        lanes(matrices).unflatten(0, (3, 3)),
        lanes(physics[:, _RATE]),
    )
    return PlantState(state, lanes(physics[:, _THRUSTS]))


def create(seed: int | None) -> type[Plant]:
    """Return the class of the plant; there is nothing to train."""
    return MujocoPlant
