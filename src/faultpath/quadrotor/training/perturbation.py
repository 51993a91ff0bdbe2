"""What is added to the waypoint controller's commands, so that the data covers a planner's."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict
from scipy.signal import lfilter

from faultpath.quadrotor.vehicle import CONTROL_RATE_HZ

Array = NDArray[np.float64]


class PerturbationSettings(BaseModel):
    """Ranges of the perturbations; what an episode gets of them is drawn for it.

    Spread and correlation are those of the planner's candidates (`planner.SamplerSettings`): a
    predictor is asked about such commands. The rest is derived (`docs/design/collection.md`).
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    thrust_sigma: float = 0.22
    """Largest standard deviation of the thrust, as a fraction of the hover thrust."""
    rate_sigma_radps: tuple[float, float, float] = (1.0, 1.0, 0.4)
    """Largest standard deviations of the body rates."""
    correlation: tuple[float, float] = (0.6, 0.85)
    """Of neighbouring steps."""
    clean_share: float = 0.15
    """Share of the episodes whose strength is at most `clean_strength`; else it is up to 1."""
    clean_strength: float = 0.1
    jitter: float = 0.3
    """Largest standard deviation of the white part, in units of the correlated one."""
    pulses_per_s: float = 0.5
    """Steps and doublets on one axis, on average."""
    pulse_steps: tuple[int, int] = (2, 6)
    """Length of a step and of each half of a doublet."""
    pulse_sigmas: tuple[float, float] = (1.0, 2.5)
    """Their height in units of the correlated part's standard deviation."""
    holds_per_s: float = 0.3
    """Stretches without feedback, on average in an episode that is not clean: a candidate of the
    planner has none over its whole horizon."""
    hold_steps: tuple[int, int] = (2, 8)


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
