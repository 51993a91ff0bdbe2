"""An estimator as a user would bring it: attitude from the gyroscope, the rest by filterpy."""

import numpy as np
import torch
from faultpath_quadrotor.estimators import Estimator
from faultpath_quadrotor.so3 import exp
from filterpy.kalman import KalmanFilter

from faultpath.system import Port

GYROSCOPE, FORCE, FIX = (
    Port(channel, "filter") for channel in ("gyroscope", "accelerometer", "position_fix")
)
LATE_S = 0.1  # of a fix when it arrives
DT_S, GRAVITY = 0.05, np.array([0.0, 0.0, -9.81])


class Filter(Estimator):
    """Turns with the gyroscope; a Kalman filter a scene follows accelerations and fixes."""

    reads = frozenset({GYROSCOPE, FORCE, FIX})
    truths = ("vehicle",)

    def step(self, inputs, memory):
        rates, forces = (inputs[port] for port in (GYROSCOPE, FORCE))  # [B, 5, 3]: 10 ms each
        fix = inputs[FIX].numpy()
        if memory is None:
            start = inputs.truth("vehicle")
            filters = [kalman(position) for position in fix]
            attitude = start["attitude"]
        else:
            filters, attitude = memory
            moved = []
            for sample in range(rates.shape[1]):
                attitude = attitude @ exp(0.2 * DT_S * rates[:, sample].T).movedim(-1, 0)
                moved.append((attitude @ forces[:, sample, :, None])[..., 0])
            pushes = torch.stack(moved).mean(0).numpy() + GRAVITY
            for tracker, push, seen in zip(filters, pushes, fix, strict=True):
                tracker.predict(u=push)
                tracker.update(seen + LATE_S * tracker.x[3:])
        states = torch.from_numpy(np.stack([tracker.x for tracker in filters]))
        known = (states[:, :3], states[:, 3:], attitude, rates[:, -1])
        return dict(zip(self.writes, known, strict=True)), (filters, attitude)


def kalman(fix):
    one = np.eye(3)
    tracker = KalmanFilter(dim_x=6, dim_z=3, dim_u=3)
    tracker.x = np.concatenate((fix, np.zeros(3)))
    tracker.F = np.block([[one, DT_S * one], [0 * one, one]])
    tracker.B = np.vstack((0.5 * DT_S**2 * one, DT_S * one))
    tracker.H = np.hstack((one, 0 * one))
    tracker.Q = tracker.B @ tracker.B.T * 0.5**2
    tracker.R, tracker.P = one * 0.05**2, np.eye(6) * 0.05**2
    return tracker


def create(seed) -> Filter:
    return Filter()
