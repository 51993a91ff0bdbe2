"""A boat with two motors, each a number of one source; it moors at zero in the wind.

faultpath check examples/boat.py:create
"""

import numpy as np

from faultpath.system import ComposedSystem, FunctionPlant, writes


@writes("wind", past="thrust")
def wind_observer(velocity, thrust, gain, memory):
    before, wind = (velocity, 0 * velocity) if memory is None else memory
    pull = np.reshape(gain, (-1, 1)) * thrust  # one gain for both motors
    wind = (wind + (velocity - before) / 0.05 - pull) / 2
    return wind, (velocity, wind)


@writes("thrust", before=[0.0, 0.0])
def pilot(position, velocity, wind, gain):
    return (-position - 2 * velocity - wind) / gain[:, None]


def moor(rng):
    position, wind = rng.uniform(-4, 4, size=2), rng.uniform(-1, 1, size=2)
    gain = rng.uniform(0.8, 1.2)
    return {"position": position, "velocity": np.zeros(2), "wind": wind, "gain": gain}


def sail(state, thrust, rng):
    velocity = state["velocity"] + (state["gain"] * thrust + state["wind"]) * 0.05
    return state | {"velocity": velocity, "position": state["position"] + velocity * 0.05}


def create() -> ComposedSystem:
    return ComposedSystem(
        "boat",
        FunctionPlant(
            moor,
            sail,
            observes={name: name for name in ("position", "velocity", "gain")},
            action="thrust",
            steps=200,
            dt_s=0.05,
            succeeded=lambda episode: np.linalg.norm(episode["position"][-1]) < 0.25,
        ),
        {"calibrated": [wind_observer, pilot], "typical": [wind_observer.given(gain=1), pilot]},
        {"position": "m", "velocity": "m/s", "gain": "1", "wind": "m/s^2", "thrust": "m/s^2"},
    )
