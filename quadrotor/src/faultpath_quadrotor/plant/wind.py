"""Wind: sustained flow, Dryden turbulence and one 1-cosine gust, as a function of time.

Wind is a world-frame series in time, not a field in space: every treatment of a contrast meets the
same wind whatever path it flies. Turbulence uses the forms of MIL-F-8785C, 3.7.1.2, along and
across the sustained flow, with three departures: length scales are capped at the size of a room,
the intensity is the same along all axes as the standard has it above 2,000 ft, and the airspeed
that turns lengths into times is a constant of the level rather than the vehicle's own.
"""

import math

import numpy as np
from numpy.typing import NDArray

from faultpath.plugin.system import Frozen, generator
from faultpath_quadrotor.vehicle import PLANT_RATE_HZ, Range

Array = NDArray[np.float64]

CRUISE_MPS = 2.5
"""Typical speed of the vehicle, for the reference airspeed."""
ELEVATION_DEG = 20.0
"""Most that the sustained flow of a level leaves the horizontal, uniform in solid angle."""
GUST_DURATION_S = (0.8, 2.0)


class Winds(Frozen):
    """How strong and how unsteady the winds are; turbulence and gust are shares of the mean."""

    means_mps: tuple[float, float, float, float] = (0.0, 0.468, 0.99, 1.8)
    """Sustained speeds of L0 to L3, matched to the paper's success with and without wind input."""
    pool_mean_mps: tuple[float, float] = (0.0, 6.0)
    """Sustained speeds of the training pool: beyond L3, as a shared fault asks the reconstruction
    for apparent winds that add to the true one."""
    turbulence: float = 1.111
    """Standard deviation along each axis: a wind that changes within a flight, as between walls,
    not MIL-F-8785C's 0.2 in the open. Matched, as are the next two."""
    length_m: float = 12.0
    """Length scale; MIL-F-8785C's near the ground exceed any room."""
    gust: Range = (0.8, 1.2)
    """Peak of the gust."""
    gust_onset_s: Range = (0.5, 4.0)

    def series(self, level: str, index: int, duration_s: float) -> Array:
        """Return an evaluation scene's wind at the plant's steps, world frame, m/s, [T, 3].

        Keyed by level and scene index alone, so that a wind recurs in every library at its index
        (paper, Section IV-B). A longer series begins with the shorter one; `KeyError` for an
        unknown level.
        """
        stream = generator(f"wind/{level}", str(index), 0)
        levels = {f"L{i}": mean for i, mean in enumerate(self.means_mps)}
        return self.sample(stream, levels[level], ELEVATION_DEG, duration_s)

    def pool_series(self, collection_seed: int, episode: int, duration_s: float) -> Array:
        """Return a training episode's wind, [T, 3] m/s, keyed by collection seed and episode.

        The sustained speed is uniform in `pool_mean_mps` and its direction uniform over the
        sphere: the reconstruction must be able to answer with vertical winds of about 6 m/s.
        """
        stream = generator("wind/collection", str(episode), collection_seed)
        return self.sample(stream, stream.uniform(*self.pool_mean_mps), 90.0, duration_s)

    def sample(
        self, stream: np.random.Generator, mean_mps: float, elevation_deg: float, duration_s: float
    ) -> Array:
        """Return a wind of this sustained speed and most elevation, world frame, m/s, [T, 3]."""
        steps = round(duration_s * PLANT_RATE_HZ)
        axes = _flow_axes(stream, elevation_deg)
        gust = one_minus_cosine(
            np.arange(steps) / PLANT_RATE_HZ,
            onset_s=stream.uniform(*self.gust_onset_s),
            duration_s=stream.uniform(*GUST_DURATION_S),
            peak=stream.uniform(*self.gust) * mean_mps,
        )
        airspeed = math.hypot(mean_mps, CRUISE_MPS)  # level wind and cruise at right angles
        turbulence = dryden(stream, steps, PLANT_RATE_HZ, airspeed, self.length_m)
        along = self.turbulence * mean_mps * turbulence
        along[:, 0] += mean_mps + gust
        # Added up here, as a library's product depends on the processor.
        return along[:, [0]] * axes[0] + along[:, [1]] * axes[1] + along[:, [2]] * axes[2]


def one_minus_cosine(time_s: Array, onset_s: float, duration_s: float, peak: float) -> Array:
    """Return the gust peak / 2 (1 - cos(2 pi s)) for s in 0..1 over its duration, else 0, [T]."""
    phase = (time_s - onset_s) / duration_s
    gust = np.zeros_like(time_s)
    blows = (phase > 0.0) & (phase < 1.0)
    # Not numpy's own cosine, whose last bits depend on the processor.
    gust[blows] = [0.5 * peak * (1.0 - math.cos(2 * math.pi * p)) for p in phase[blows].tolist()]
    return gust


def dryden(
    stream: np.random.Generator, steps: int, rate_hz: float, airspeed_mps: float, length_m: float
) -> Array:
    """Return turbulence of unit standard deviation along and twice across the flow, [steps, 3].

    With T the length scale over the airspeed, the forms are sqrt(2 T) / (1 + T s) along and
    sqrt(T) (1 + sqrt(3) T s) / (1 + T s)^2 across, driven by white noise of unit intensity. Both
    are sums of the states of 1 / (1 + T s) and 1 / (1 + T s)^2, whose sampled recursion, noise
    covariance and stationary covariance are exact: the series has its standard deviation from
    its first sample on, at any rate.
    """
    from scipy.signal import lfilter  # slow to load, and only those who fly need it

    time_constant = length_m / airspeed_mps
    ratio = 1.0 / (rate_hz * time_constant)
    decay = math.exp(-ratio)
    # Covariances of both states as three numbers each, at any moment and of what a step adds.
    one, both, two = (part / (4.0 * time_constant) for part in (2.0, 1.0, 1.0))
    kept_both = ratio * one + both
    kept_two = ratio * (ratio * one + both) + ratio * both + two
    start = _root(one, both, two)
    kept = decay * decay
    noise = _root(one - kept * one, both - kept * kept_both, two - kept * kept_two)

    draws = stream.standard_normal((steps, 5))
    first_in, second_in = np.empty((steps, 3)), np.empty((steps, 2))
    lateral = draws[:, 1:].reshape(steps, 2, 2)
    first_in[:, 0] = noise[0] * draws[:, 0]
    first_in[:, 1:] = noise[0] * lateral[..., 0]
    second_in[:] = noise[1] * lateral[..., 0] + noise[2] * lateral[..., 1]
    first_in[0] = start[0] * np.concatenate((draws[0, :1], lateral[0, :, 0]))
    second_in[0] = start[1] * lateral[0, :, 0] + start[2] * lateral[0, :, 1]

    first = lfilter([1.0], [1.0, -decay], first_in, axis=0)
    second_in[1:] += decay * ratio * first[:-1, 1:]
    second = lfilter([1.0], [1.0, -decay], second_in, axis=0)

    along = math.sqrt(2.0 * time_constant) * first[:, :1]
    root = math.sqrt(3.0)
    across = math.sqrt(time_constant) * (root * first[:, 1:] + (1.0 - root) * second)
    return np.concatenate((along, across), axis=1)


def _root(one: float, both: float, two: float) -> tuple[float, float, float]:
    """Return the lower triangle that times its transpose is `[[one, both], [both, two]]`."""
    first = math.sqrt(one)
    return first, both / first, math.sqrt(two - (both / first) ** 2)


def _flow_axes(stream: np.random.Generator, elevation_deg: float) -> Array:
    azimuth = stream.uniform(-np.pi, np.pi)
    sine = math.sin(math.radians(elevation_deg)) * stream.uniform(-1.0, 1.0)
    cosine = math.sqrt(1.0 - sine * sine)
    flat = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    along = cosine * flat + np.array([0.0, 0.0, sine])
    side = np.array([-flat[1], flat[0], 0.0])
    return np.stack((along, side, np.cross(along, side)))
