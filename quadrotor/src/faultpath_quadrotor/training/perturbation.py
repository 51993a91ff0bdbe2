"""What is added to the waypoint controller's commands, so that the data covers a planner's."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from faultpath_quadrotor.platform import PerturbationSettings
from faultpath_quadrotor.vehicle import CONTROL_RATE_HZ

Array = NDArray[np.float64]


class Perturbation(NamedTuple):
    """The perturbation of one episode, for each control step."""

    offset: Array
    """[4, N]: thrust as a fraction of the hover thrust, body rates in rad/s."""
    held: NDArray[np.bool_]
    """[N]: whether the controller's command of the step before is used again, below the offset."""


def draw(stream: np.random.Generator, steps: int, settings: PerturbationSettings) -> Perturbation:
    """Return the perturbation of an episode of `steps` control steps, drawn from `stream`."""
    clean = stream.uniform() < settings.clean_share
    low, high = (0.0, settings.clean_strength) if clean else (settings.clean_strength, 1.0)
    thrust, rates = stream.uniform(low, high, 2)
    sigma = np.array((settings.thrust_sigma, *settings.rate_sigma_radps))
    sigma *= np.array((thrust, rates, rates, rates))
    noise = _autoregressive(stream, steps, stream.uniform(*settings.correlation))
    jitter = stream.uniform(0.0, settings.jitter) * stream.standard_normal((4, steps))
    pulses = np.zeros((4, steps))
    for _ in range(stream.poisson(settings.pulses_per_s * steps / CONTROL_RATE_HZ)):
        _add_pulse(stream, pulses, settings)
    held = np.zeros(steps, dtype=bool)
    for _ in range(stream.poisson(high * settings.holds_per_s * steps / CONTROL_RATE_HZ)):
        first = stream.integers(1, steps)
        held[first : first + stream.integers(*settings.hold_steps, endpoint=True)] = True
    return Perturbation(sigma[:, None] * (noise + jitter + pulses), held)


def _autoregressive(stream: np.random.Generator, steps: int, correlation: float) -> Array:
    """Stationary AR(1) noise of unit standard deviation, [4, steps]."""
    fresh = np.sqrt(1 - correlation**2)
    innovations = fresh * stream.standard_normal((4, steps))
    innovations[:, 0] /= fresh
    return lfilter([1.0], [1.0, -correlation], innovations, axis=1)


def _add_pulse(stream: np.random.Generator, pulses: Array, settings: PerturbationSettings) -> None:
    """Add a held step or, every other time, a doublet (a step and its reverse) to one axis."""
    axis = stream.integers(4)
    first = stream.integers(pulses.shape[1])
    width = stream.integers(*settings.pulse_steps, endpoint=True)
    height = stream.uniform(*settings.pulse_sigmas) * stream.choice((-1.0, 1.0))
    pulses[axis, first : first + width] += height
    if stream.uniform() < 0.5:
        pulses[axis, first + width : first + 2 * width] -= height
