"""An error-state Kalman filter of pose, velocity and inertial biases, batched over lanes.

The state is carried by the inertial samples; the filter holds the covariance of its error, in the
order position, velocity (world frame), rotation vector (body frame, R = R^ exp(error)), gyroscope
bias, accelerometer bias (Sola, "Quaternion kinematics for the error-state Kalman filter", 2017;
increments as in Forster et al., "On-manifold preintegration", 2017). Everything has lanes last and
is made of sums over the components before them, so that a lane's bits do not depend on the others.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from faultpath_quadrotor import so3
from faultpath_quadrotor.estimators.sensors import SAMPLE_DT_S, SAMPLES, Sensor
from faultpath_quadrotor.vehicle import CONTROL_DT_S, GRAVITY_MPS2

_P, _V, _R, _G, _A = (slice(3 * part, 3 * part + 3) for part in range(5))
SIZE = 15
_MANOEUVRE_S = 0.5
_STARTS = {"velocity": 0.05, "tilt": 0.02}
"""Standard deviations of a start from rest on level ground, m/s and rad (derived)."""


@dataclass(frozen=True)
class Increment:
    """How a control interval moves a body, seen from its attitude at the beginning."""

    turn: Tensor
    """`[3, 3, *b]`"""
    gained: Tensor
    """Velocity, `[3, *b]`, m/s, without gravity."""
    moved: Tensor
    """Position, `[3, *b]`, m, without gravity and the first velocity."""
    lever: Tensor
    """Mean attitude over the interval times its length, `[3, 3, *b]`, s."""

    @classmethod
    def of(cls, rate: Tensor, force: Tensor) -> Increment:
        """Return the increment of bias-free samples, `[SAMPLES, 3, *b]` each, rad/s and m/s^2."""
        half = so3.exp(0.5 * SAMPLE_DT_S * rate.transpose(0, 1))  # [3, 3, SAMPLES, *b]
        full = so3.compose(half, half)
        turn = torch.zeros_like(half[:, :, 0])
        turn[0, 0] = turn[1, 1] = turn[2, 2] = 1.0
        gained = moved = torch.zeros_like(force[0])
        lever = torch.zeros_like(turn)
        for sample in range(SAMPLES):
            middle = so3.compose(turn, half[:, :, sample])
            push = so3.rotate(middle, force[sample]) * SAMPLE_DT_S
            moved = moved + (gained + 0.5 * push) * SAMPLE_DT_S
            gained = gained + push
            lever = lever + middle * SAMPLE_DT_S
            turn = so3.compose(turn, full[:, :, sample])
        return cls(turn, gained, moved, lever)


@dataclass(frozen=True)
class Belief:
    """Estimate of each lane's state, and the covariance of its error."""

    position: Tensor
    velocity: Tensor
    rotation: Tensor
    gyroscope_bias: Tensor
    accelerometer_bias: Tensor
    covariance: Tensor
    """Covariance of the error, `[15, 15, L]`."""

    @classmethod
    def at_rest(cls, fix: Tensor, heading: Tensor, trust: Trust) -> Belief:
        """Return the belief of vehicles at rest on level ground, from their first readings."""
        zero = torch.zeros_like(fix)
        known, tilt = trust.sensors, torch.full_like(zero, _STARTS["tilt"])
        tilt[2] = trust.noise("heading")
        spread = (
            torch.full_like(zero, trust.noise("position_fix")),
            torch.full_like(zero, _STARTS["velocity"]),
            tilt,
            torch.full_like(zero, known["gyroscope"].bias * trust.biases),
            torch.full_like(zero, known["accelerometer"].bias * trust.biases),
        )
        variance = torch.cat(spread).square()
        covariance = torch.zeros(SIZE, *variance.shape).to(variance)
        for row in range(SIZE):
            covariance[row, row] = variance[row]
        return cls(fix, zero, so3.from_yaw(heading), zero, zero, covariance)


def carried(
    position: Tensor, velocity: Tensor, rotation: Tensor, by: Increment
) -> tuple[Tensor, Tensor, Tensor]:
    """Return position, velocity and attitude an interval later."""
    dt = CONTROL_DT_S
    ahead = position + velocity * dt + so3.rotate(rotation, by.moved)
    ahead[2] -= 0.5 * GRAVITY_MPS2 * dt * dt
    faster = velocity + so3.rotate(rotation, by.gained)
    faster[2] -= GRAVITY_MPS2 * dt
    return ahead, faster, so3.compose(rotation, by.turn)


@dataclass(frozen=True)
class Trust:
    """Errors that the filter assumes of its sensors."""

    sensors: Mapping[str, Sensor]
    biases: bool = True
    """Whether it estimates those of gyroscope and accelerometer; otherwise they count as zero."""
    doubt: float = 1.0
    """Factor on the noise of readings that correct it: fixes, altitude and heading."""

    def noise(self, name: str) -> float:
        """Return the standard deviation assumed of readings that correct the filter."""
        return self.sensors[name].noise * self.doubt


def predicted(belief: Belief, by: Increment, trust: Trust) -> Belief:
    """Return the belief a control interval later, from inertial samples alone."""
    dt, rotation = CONTROL_DT_S, belief.rotation
    position, velocity, turned = carried(belief.position, belief.velocity, rotation, by)
    leans = -so3.compose(rotation, so3.skew(by.gained))
    lever = so3.compose(rotation, by.lever)
    one = torch.zeros_like(leans)
    one[0, 0] = one[1, 1] = one[2, 2] = 1.0
    step = torch.zeros_like(belief.covariance)
    for part in range(SIZE):
        step[part, part] = 1.0
    step[_P, _V] = dt * one
    step[_P, _R] = -so3.compose(rotation, so3.skew(by.moved))
    step[_P, _G] = -leans * (dt * dt / 6.0)
    step[_P, _A] = -0.5 * dt * lever
    step[_V, _R] = leans
    step[_V, _G] = -leans * (0.5 * dt)
    step[_V, _A] = -lever
    step[_R, _R] = by.turn.transpose(0, 1)
    step[_R, _G] = -dt * one
    covariance = _product(_product(step, belief.covariance), step.transpose(0, 1))
    pushed = _diffused(trust.sensors["accelerometer"], by.gained / dt)
    turns = _diffused(trust.sensors["gyroscope"], so3.log(by.turn) / dt)
    covariance[_P, _P] += one * (pushed * dt * dt / 3.0)
    covariance[_P, _V] += one * (pushed * dt / 2.0)
    covariance[_V, _P] += one * (pushed * dt / 2.0)
    covariance[_V, _V] += one * pushed
    covariance[_R, _R] += one * turns
    if trust.biases:
        covariance[_G, _G] += one * (trust.sensors["gyroscope"].walk ** 2 * dt)
        covariance[_A, _A] += one * (trust.sensors["accelerometer"].walk ** 2 * dt)
    return replace(
        belief, position=position, velocity=velocity, rotation=turned, covariance=covariance
    )


def _diffused(sensor: Sensor, mean: Tensor) -> Tensor:
    """Return the variance that an interval adds to the sum of a sensor's samples, `[L]`.

    Scale errors and misalignment are constant, but motion changes the direction of their effect:
    they count as noise that lasts as long as a manoeuvre.
    """
    turned = sensor.scale**2 * mean.square().sum(0) * (_MANOEUVRE_S * CONTROL_DT_S)
    return turned + SAMPLES * (sensor.noise * SAMPLE_DT_S) ** 2


@dataclass(frozen=True)
class Innovation:
    """Difference between a reading and its expected value, and its variance, `[L]` each."""

    value: Tensor
    variance: Tensor


def corrected(
    belief: Belief, read: Mapping[str, Tensor], trust: Trust
) -> tuple[Belief, list[Innovation]]:
    """Return the belief after readings `[..., L]` of its own moment, taken in one number at a time.

    `read` may hold `position_fix`, `altitude` and `heading`.
    """
    measurements: list[tuple[Tensor, Tensor, float]] = []
    for axis in range(3 if "position_fix" in read else 0):
        residual = read["position_fix"][axis] - belief.position[axis]
        measurements.append((residual, _row(belief, {axis: 1.0}), trust.noise("position_fix")))
    if "altitude" in read:
        residual = read["altitude"] - belief.position[2]
        measurements.append((residual, _row(belief, {2: 1.0}), trust.noise("altitude")))
    if "heading" in read:
        r = belief.rotation
        difference = read["heading"] - so3.heading(r)
        residual = torch.atan2(*so3.sine_cosine(difference))
        level = (r[0, 0].square() + r[1, 0].square()).clamp_min(1e-3)
        about = {
            7: (r[1, 0] * r[0, 2] - r[0, 0] * r[1, 2]) / level,
            8: (r[0, 0] * r[1, 1] - r[1, 0] * r[0, 1]) / level,
        }
        measurements.append((residual, _row(belief, about), trust.noise("heading")))
    error, covariance = torch.zeros_like(belief.covariance[0]), belief.covariance
    innovations: list[Innovation] = []
    for residual, row, noise in measurements:
        spread = (covariance * row).sum(1)
        variance = (row * spread).sum(0) + noise**2
        gain = spread / variance
        innovations.append(Innovation(residual - (row * error).sum(0), variance))
        error = error + gain * innovations[-1].value
        covariance = covariance - gain[:, None] * spread
    return (
        Belief(
            belief.position + error[_P],
            belief.velocity + error[_V],
            so3.compose(belief.rotation, so3.exp(error[_R])),
            belief.gyroscope_bias + error[_G],
            belief.accelerometer_bias + error[_A],
            0.5 * (covariance + covariance.transpose(0, 1)),
        ),
        innovations,
    )


def _row(belief: Belief, entries: Mapping[int, Tensor | float]) -> Tensor:
    row = torch.zeros_like(belief.covariance[0])
    for index, entry in entries.items():
        row[index] = entry
    return row


def _product(first: Tensor, second: Tensor) -> Tensor:
    """Return `first @ second`, `[15, 15, L]` each, added up in a fixed order."""
    total = first[:, 0, None] * second[0]
    for middle in range(1, SIZE):
        total = torch.addcmul(total, first[:, middle, None], second[middle])
    return total
