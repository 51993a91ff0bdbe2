"""The 500 Hz inner loop: body-rate command to motor commands."""

import torch
from torch import Tensor

from faultpath_quadrotor.plant.motors import WRENCH_PER_THRUST, column
from faultpath_quadrotor.plant.vehicle_batch import Vehicle
from faultpath_quadrotor.vehicle import MOTOR_THRUST_MAX_N, RATE_GAIN_PER_S


class RateLoop:
    """Proportional rate control with gyroscopic feed-forward, a mixer and per-motor limits.

    Wanted torque: I K (command - rate) + rate x I rate. The controller knows the vehicle's
    inertia but neither its scales nor its motor lag, so the loop's true gain is the torque scale
    times K. Where motors cannot give it all, yaw gives way first, as its motor strokes are the
    longest (Faessler et al. 2017, "Thrust Mixing, Saturation, and Body-Rate Control"); then each
    motor is clipped by itself.
    """

    per_acceleration: Tensor
    """Thrust of each motor per wanted angular acceleration about each axis, [3, 4, *b]."""

    def __init__(self, vehicle: Vehicle) -> None:
        like = vehicle.mass_kg
        wrench = column(WRENCH_PER_THRUST, like)
        inverse = wrench / (wrench * wrench).sum(1, keepdim=True)
        self.per_acceleration = inverse[1:] * vehicle.inertia_kgm2[:, None]
        self._gain = column(RATE_GAIN_PER_S, like)
        self._roll, self._pitch = self.per_acceleration[0], self.per_acceleration[1]
        self._yaw = self.per_acceleration[2, 0]
        self._ceiling = column((MOTOR_THRUST_MAX_N,), like)
        self._spin = column(WRENCH_PER_THRUST[3], like).sign()

    def target(self, rate_command: Tensor) -> Tensor:
        """Return K times the command [3, *b]: constant while the command is."""
        return self._gain * rate_command

    def motor_commands(
        self, level: Tensor, target: Tensor, rate: Tensor, gyroscopic: Tensor
    ) -> Tensor:
        """Return the four motors' commands, [4, *b] N, each within its limits.

        `level` [*b] is a quarter of the collective command in N, `target` [3, *b] comes from
        `target`, `rate` [3, *b] is the body rate and `gyroscopic` [3, *b] the angular
        acceleration that it causes by itself, rad/s^2.
        """
        wanted = torch.addcmul(target, self._gain, rate, value=-1.0).sub_(gyroscopic)
        roll, pitch, yaw = wanted.unbind(0)
        thrusts = torch.addcmul(level, self._roll, roll).addcmul_(self._pitch, pitch)
        thrusts = thrusts.clamp_(0.0, MOTOR_THRUST_MAX_N)
        room = torch.minimum(thrusts, self._ceiling - thrusts).amin(0)
        stroke = torch.clamp(self._yaw * yaw, -room, room)
        return thrusts.addcmul_(self._spin, stroke)
