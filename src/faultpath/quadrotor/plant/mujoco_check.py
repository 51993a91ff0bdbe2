"""A second plant, on MuJoCo, that shares no equation of motion with the first.

It exists to check the first one (extra `[mujoco]`), one vehicle at a time and in plain NumPy.
MuJoCo integrates the free body, the motors' lag (`filterexact`) and the drag, which three site
velocity actuators give exactly: force c (R^T w - v_body) along each body axis. Rate loop and
mixer are written again here, from force balance at the motors' places. MuJoCo's own wind is a
different fluid model and stays off.
"""

# MuJoCo is a compiled module whose names pyright cannot see.
# pyright: reportAttributeAccessIssue=false, reportUnknownMemberType=false
# pyright: reportUnknownVariableType=false

import math

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from faultpath.quadrotor.vehicle import (
    ARM_LENGTH_M,
    GRAVITY_MPS2,
    MOTOR_THRUST_MAX_N,
    PLANT_DT_S,
    RATE_GAIN_PER_S,
    RATE_LIMIT_RADPS,
    TORQUE_COEFFICIENT_M,
    VehicleParameters,
)

Array = NDArray[np.float64]

_BEARINGS_DEG = (45.0, 135.0, 225.0, 315.0)  # front left, rear left, rear right, front right
_SPINS = (1.0, -1.0, 1.0, -1.0)


def _wrenches() -> Array:
    """Return each motor's force and torque on the body per newton, [4 motors, 6]."""
    rows = []
    for bearing, spin in zip(np.radians(_BEARINGS_DEG), _SPINS, strict=True):
        place = ARM_LENGTH_M * np.array([math.cos(bearing), math.sin(bearing), 0.0])
        torque = np.cross(place, [0.0, 0.0, 1.0])
        torque[2] += spin * TORQUE_COEFFICIENT_M
        rows.append([0.0, 0.0, 1.0, *torque])
    return np.array(rows)


def _numbers(values: ArrayLike) -> str:
    return " ".join(repr(float(x)) for x in np.atleast_1d(values))


def build_model(vehicle: VehicleParameters, timestep_s: float) -> mujoco.MjModel:
    """Return the MuJoCo model of one vehicle; actuators: four motors, then drag x, y, z."""
    scale = np.array([vehicle.thrust_scale] * 3 + [vehicle.torque_scale] * 3)
    motors = "".join(
        f'<general site="centre" gear="{_numbers(wrench * scale)}" dyntype="filterexact" '
        f'dynprm="{vehicle.motor_time_constant_s!r}" gainprm="1"/>'
        for wrench in _wrenches()
    )
    drag = "".join(
        f'<velocity site="centre" gear="{_numbers(np.eye(6)[axis])}" kv="{coefficient!r}"/>'
        for axis, coefficient in enumerate(vehicle.drag_kgps)
    )
    return mujoco.MjModel.from_xml_string(f"""
        <mujoco>
          <option timestep="{timestep_s!r}" gravity="0 0 {-GRAVITY_MPS2!r}" integrator="Euler"/>
          <worldbody>
            <body name="vehicle">
              <freejoint/>
              <inertial pos="0 0 0" mass="{vehicle.mass_kg!r}"
                        diaginertia="{_numbers(vehicle.inertia_kgm2)}"/>
              <site name="centre"/>
            </body>
          </worldbody>
          <actuator>{motors}{drag}</actuator>
        </mujoco>""")


class MujocoPlant:
    """One vehicle on MuJoCo, with the rate loop at 500 Hz and finer steps of integration."""

    def __init__(
        self,
        vehicle: VehicleParameters,
        position: Array,
        velocity: Array,
        rotation: Array,
        rate: Array,
        substeps: int = 20,
    ) -> None:
        """Start at a state (one lane of a `State`) with motors at hover trim."""
        self._vehicle = vehicle
        self._substeps = substeps
        self._model = build_model(vehicle, PLANT_DT_S / substeps)
        self._mix = np.linalg.inv(_wrenches()[:, 2:].T)
        self._data = mujoco.MjData(self._model)
        self._data.qpos[:3] = position
        mujoco.mju_mat2Quat(self._data.qpos[3:], np.ascontiguousarray(rotation).ravel())
        self._data.qvel[:3], self._data.qvel[3:] = velocity, rate
        hover = vehicle.mass_kg * GRAVITY_MPS2 / vehicle.thrust_scale
        self._data.act[:] = hover / 4

    @property
    def position(self) -> Array:
        """World frame, m, [3]."""
        return self._data.qpos[:3].copy()

    @property
    def velocity(self) -> Array:
        """World frame, m/s, [3]."""
        return self._data.qvel[:3].copy()

    @property
    def rotation(self) -> Array:
        """Body to world, [3, 3]."""
        matrix = np.empty(9)
        mujoco.mju_quat2Mat(matrix, self._data.qpos[3:])
        return matrix.reshape(3, 3)

    @property
    def rate(self) -> Array:
        """Body frame, rad/s, [3]."""
        return self._data.qvel[3:].copy()

    def advance(self, command: Array, winds: Array) -> None:
        """Advance 2 ms for each of `winds` [n, 3] m/s under a held `command` [4]."""
        for wind_mps in winds:
            self._data.ctrl[:4] = self._motor_commands(command)
            for _ in range(self._substeps):
                self._data.ctrl[4:] = self.rotation.T @ wind_mps
                mujoco.mj_step(self._model, self._data)

    def _motor_commands(self, command: Array) -> Array:
        limit = np.array(RATE_LIMIT_RADPS)
        inertia = np.array(self._vehicle.inertia_kgm2)
        rate = self.rate
        error = np.clip(command[1:], -limit, limit) - rate
        torque = inertia * RATE_GAIN_PER_S * error + np.cross(rate, inertia * rate)
        collective = np.clip(command[0], 0.0, 4 * MOTOR_THRUST_MAX_N)
        level = np.clip(self._mix[:, :3] @ [collective, *torque[:2]], 0.0, MOTOR_THRUST_MAX_N)
        room = min(level.min(), MOTOR_THRUST_MAX_N - level.max())
        stroke = self._mix[:, 3] * torque[2]
        return level + stroke * min(1.0, room / max(np.abs(stroke).max(), 1e-300))
