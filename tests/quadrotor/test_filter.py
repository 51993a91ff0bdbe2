"""The error-state filter is one: it is as sure as it is right, and agrees with another."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from faultpath_quadrotor import so3
from faultpath_quadrotor.estimators.kalman import SIZE
from faultpath_quadrotor.estimators.sensors import SAMPLE_DT_S, sensors
from filter_toys import LANES, Sensed, courses, filtered
from filterpy.kalman import ExtendedKalmanFilter
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

STEPS, REPEATS = 100, 32
GRAVITY = np.array([0.0, 0.0, 9.81])
FLIGHTS = LANES * REPEATS


@pytest.fixture(scope="module")
def flown():
    states, exact = courses(STEPS)
    return states, Sensed.of(exact, REPEATS)


def test_errors_of_a_thousand_flights_are_as_large_as_the_filter_says(flown):
    states, sensed = flown
    draw = torch.Generator().manual_seed(0)
    start = torch.randn(6, FLIGHTS, generator=draw, dtype=torch.float64)
    start *= torch.tensor([0.05, 0.05, 0.05, 0.02, 0.02, 0.0], dtype=torch.float64)[:, None]
    late = sensors()["position_fix"].late
    squares, innovations, first, last = [], [], None, None
    for step, now in enumerate(filtered(sensed, start)):
        belief, true, biases = now.belief, states[max(0, step - late)], sensed.biases[step]
        turned = so3.compose(belief.rotation.transpose(0, 1), true.rotation.repeat(1, 1, REPEATS))
        apart = [
            true.position.repeat(1, REPEATS) - belief.position,
            true.velocity.repeat(1, REPEATS) - belief.velocity,
            so3.log(turned),
            biases - torch.cat((belief.gyroscope_bias, belief.accelerometer_bias)),
        ]
        error = torch.cat(apart)
        weighed = torch.linalg.solve(belief.covariance.movedim(-1, 0), error.T[..., None])[..., 0]
        squares.append(float((error.T * weighed).sum(1).mean()))
        last = error[9:].std(1)
        first = last if first is None else first
        if len(now.innovations) == 5:
            innovations.append(torch.stack([e.value / e.variance.sqrt() for e in now.innovations]))
    low, high = chi2.ppf([0.001, 0.999], SIZE * FLIGHTS) / FLIGHTS
    assert low < np.mean(squares) < high
    assert all(0.97 * low < each < 1.03 * high for each in squares)
    white = torch.stack(innovations)  # [times, 5, flights]
    low, high = chi2.ppf([0.001, 0.999], white.numel()) / white.numel()
    assert low < float(white.square().mean()) < high
    follows = (white[1:] * white[:-1]).mean((0, 2))
    assert follows.abs().max() < 4.0 / np.sqrt(white[1:, 0].numel())
    assert (last[:3] < 0.25 * first[:3]).all()  # biases of the gyroscope are found
    assert (last[3:] < 0.7 * first[3:]).all()  # those of the accelerometer more slowly


def test_another_implementation_estimates_the_same(flown):
    """filterpy's filter with derivatives by differences, one flight, all numbers of a reading at
    once."""
    _, many = flown
    alone = [{name: value[..., :1] for name, value in read.items()} for read in many.read]
    sensed = replace(many, read=alone)
    other, late = _Other(sensed.read[0]), sensors()["position_fix"].late
    for step, (now, read) in enumerate(zip(filtered(sensed), sensed.read, strict=True)):
        if step > late:
            before, at = sensed.read[step - late], step - late
            fix = read["position_fix"] if at % 2 == 0 else None
            other.step(before, fix)
        belief = now.belief
        assert np.abs(belief.position[:, 0].numpy() - other.position).max() < 2e-4
        assert np.abs(belief.velocity[:, 0].numpy() - other.velocity).max() < 1e-3
        turned = Rotation.from_matrix(belief.rotation[..., 0].numpy()).inv() * other.attitude
        assert np.abs(turned.as_rotvec()).max() < 2e-4
        biases = torch.cat((belief.gyroscope_bias, belief.accelerometer_bias))[:, 0].numpy()
        assert np.abs(biases - other.biases).max() < 2e-3


class _Other:
    """Written from the equations of motion alone."""

    def __init__(self, read):
        known = sensors()
        self.position = read["position_fix"][:, 0].numpy()
        self.velocity, self.biases = np.zeros(3), np.zeros(6)
        self.attitude = Rotation.from_euler("z", read["heading"][0].item())
        spread = [0.02] * 3 + [0.05] * 3 + [0.02] * 3 + [0.01] * 3 + [0.1] * 3
        self.filter = ExtendedKalmanFilter(dim_x=SIZE, dim_z=5)
        self.filter.x = np.zeros(SIZE)
        self.filter.P = np.diag(np.square(spread))
        self._gyroscope, self._accelerometer = known["gyroscope"], known["accelerometer"]

    def step(self, read, fix):
        rates, forces = (read[n][..., 0].numpy() for n in ("gyroscope", "accelerometer"))

        def ahead(error):
            position, velocity, attitude, biases = self._with(error)
            for rate, force in zip(rates - biases[:3], forces - biases[3:], strict=True):
                half = Rotation.from_rotvec(0.5 * SAMPLE_DT_S * rate)
                push = (attitude * half).apply(force) - GRAVITY
                position = position + SAMPLE_DT_S * velocity + 0.5 * SAMPLE_DT_S**2 * push
                velocity = velocity + SAMPLE_DT_S * push
                attitude = attitude * half * half
            return position, velocity, attitude, biases

        moved = ahead(np.zeros(SIZE))
        self.filter.F = _slope(lambda error: _apart(ahead(error), moved))
        noise, dt = np.zeros((SIZE, SIZE)), 0.05
        turned = moved[2].as_matrix().T @ self.attitude.as_matrix()
        rate = Rotation.from_matrix(turned).magnitude() / dt
        gained = np.linalg.norm(moved[1] - self.velocity + dt * GRAVITY) / dt
        push, turn = (
            5 * (each.noise * SAMPLE_DT_S) ** 2 + each.scale**2 * mean**2 * 0.5 * dt
            for each, mean in ((self._accelerometer, gained), (self._gyroscope, rate))
        )
        one = np.eye(3)
        noise[:3, :3], noise[3:6, 3:6] = one * push * dt**2 / 3, one * push
        noise[6:9, 6:9] = one * turn
        noise[:3, 3:6] = noise[3:6, :3] = one * push * dt / 2
        noise[9:12, 9:12] = one * self._gyroscope.walk**2 * dt
        noise[12:, 12:] = one * self._accelerometer.walk**2 * dt
        self.filter.Q = noise
        self.position, self.velocity, self.attitude, self.biases = moved
        self.filter.predict()
        self.filter.x = np.zeros(SIZE)
        said = [read["altitude"][0].item(), read["heading"][0].item()]
        said = np.array([*([] if fix is None else fix[:, 0].numpy()), *said])

        def expected(error):
            position, _, attitude, _ = self._with(error)
            where = [] if fix is None else [*position]
            x, y, _ = attitude.apply([1.0, 0.0, 0.0])
            return np.array([*where, position[2], np.arctan2(y, x)])

        beside = said - expected(np.zeros(SIZE))
        beside[-1] = np.angle(np.exp(1j * beside[-1]))
        spread, none = np.eye(len(said)) * 0.02**2, np.zeros(len(said))
        self.filter.update(beside, lambda _: _slope(expected), lambda _: none, R=spread)
        found = self._with(self.filter.x)
        self.position, self.velocity, self.attitude, self.biases = found
        self.filter.x = np.zeros(SIZE)

    def _with(self, error):
        turned = self.attitude * Rotation.from_rotvec(error[6:9])
        position, velocity = self.position + error[:3], self.velocity + error[3:6]
        return position, velocity, turned, self.biases + error[9:]


def _apart(one, other):
    turned = (other[2].inv() * one[2]).as_rotvec()
    return np.concatenate((one[0] - other[0], one[1] - other[1], turned, one[3] - other[3]))


def _slope(function, size=1e-6):
    steps = np.eye(SIZE) * size
    return np.stack([(function(each) - function(-each)) / (2 * size) for each in steps], axis=1)
