"""An inverted pendulum that nobody here wrote: Gymnasium's, on MuJoCo.

Two modules need the gain of the cart's motor, newtons for a unit of command:

    filter      a Kalman filter; it also estimates the force that nobody ordered, for which it has
                to know which force was ordered: gain * command
    regulator   command = (wanted force - estimated force) / gain

Baseline `calibrated`: the filter uses the gain that was measured on this unit, as the regulator
does. Repair `nominal`: the filter uses the data sheet's, so a bad calibration cannot mislead it.

    faultpath audit examples/pendulum.py:create --baseline calibrated --repair nominal \
        --fault motor_gain:scale=0.8
"""

# --- model ---
import numpy as np
from scipy.linalg import expm, solve_discrete_are

from faultpath.system import ComposedSystem, GymnasiumPlant, Measure, Metric, Parts, writes

DATA_SHEET_GAIN, DT_S = 100.0, 0.04  # N a unit of command; s a control step


def model():
    """Return state [cart, angle, their rates, unordered force] one step on, and what force adds."""
    total, pole, centre, inertia, damping = 15.49, 5.02, 0.3, 0.64, 1.0
    mass = [[total, pole * centre], [pole * centre, inertia]]
    rates = np.linalg.solve(
        mass, [[0, 0, -damping, 0, 1], [0, pole * 9.81 * centre, 0, -damping, 0]]
    )
    flow = np.zeros((6, 6))
    flow[:2, 2:4], flow[2:4, :5], flow[2:4, 5] = np.eye(2), rates, rates[:, 4]
    step = expm(flow * DT_S)
    return step[:5, :5], step[:5, 5]


A, B = model()
SEEN = np.eye(2, 5)
SPREAD = solve_discrete_are(A.T, SEEN.T, np.diag([1e-6, 1e-6, 1e-4, 1e-4, 4.0]), 1e-6 * np.eye(2))
INNOVATION = SPREAD @ SEEN.T @ np.linalg.inv(SEEN @ SPREAD @ SEEN.T + 1e-6 * np.eye(2))
COST = solve_discrete_are(A[:4, :4], B[:4, None], np.diag([20.0, 50.0, 1.0, 1.0]), [[1e-3]])
FEEDBACK = B[:4] @ COST @ A[:4, :4] / (1e-3 + B[:4] @ COST @ B[:4])


# --- modules ---
def applied(matrix, rows):
    """Return a matrix times each row; `@` would round otherwise for another number of scenes."""
    return (matrix * rows[:, None]).sum(axis=-1)


@writes("state", past="command")
def filter(encoders, command, motor_gain, memory):
    if memory is None:
        memory = np.hstack([encoders, np.zeros((len(encoders), 3))])
    state = applied(A, memory) + (motor_gain * command)[:, None] * B
    state = state + applied(INNOVATION, encoders - state[:, :2])
    return state, state


@writes("command", before=0.0)
def regulator(state, motor_gain):
    force = -(state[:, :4] * FEEDBACK).sum(axis=-1) - state[:, 4]
    return np.clip(force / motor_gain, -3.0, 3.0)


# --- scenes ---
def setup(env, rng):
    """Give each scene its own motor, and a force that pulls at the cart."""
    world = env.unwrapped
    world.model.actuator_gear[0, 0] = gain = rng.uniform(80.0, 120.0)
    world.data.qfrc_applied[0] = rng.uniform(-40.0, 40.0)
    return {"motor_gain": gain}


def cart_and_pole(env):
    """Draw the scene as a line: the cart is 0.4 m long, the pole 0.6 m."""
    place, angle = env.unwrapped.data.qpos
    tip = place + 0.6 * np.sin(angle), 0.6 * np.cos(angle)
    return [(place - 0.2, 0), (place + 0.2, 0), (place, 0), tip]


def offset_m(episode):
    """Return how far from the middle of its rail the cart came to rest."""
    return abs(episode["encoders"][-25:, 0].mean())


# --- system ---
def create() -> ComposedSystem:
    plant = GymnasiumPlant(
        "InvertedPendulum-v5",
        observes={"encoders": slice(0, 2)},
        action="command",
        steps=200,
        setup=setup,
        render=cart_and_pole,
        succeeded=lambda episode: not episode.terminated and offset_m(episode) <= 0.05,
        metrics={"offset_m": Measure(Metric(unit="m", better="less"), offset_m)},
    )
    by_data_sheet = filter.given(motor_gain=DATA_SHEET_GAIN)
    return ComposedSystem(
        "pendulum",
        plant,
        variants={
            "calibrated": Parts("The filter uses the calibration.", [filter, regulator]),
            "nominal": Parts("The filter uses the data sheet.", [by_data_sheet, regulator]),
        },
        units={
            "encoders": {"unit": "m, rad", "components": ("place", "angle")},
            "motor_gain": "N",
            "state": {
                "unit": "m, rad, m/s, rad/s, N",
                "components": ("place", "angle", "speed", "rate", "force"),
            },
            "command": "1",
        },
    )
