"""RotorPy's Hummingbird hovers in wind: its plant, sensors, controller and wind filter, untouched.

`SE3Control` reads `mass` and `k_eta`; `WindUKF`, which tells the wind by how the vehicle moves,
reads `mass`, `c_Dx`, `c_Dy` and `c_Dz`. Baseline `alone`: the controller as it comes. Repair
`fed-forward`: it also works against what that wind does, for which the mass is needed once more.

    faultpath audit examples/rotorpy_wind.py:create --baseline alone --repair fed-forward \
        --fault mass:scale=0.8 --scenes 60
"""

# --- modules ---
from types import SimpleNamespace

import numpy as np
from rotorpy.controllers.quadrotor_control import SE3Control
from rotorpy.estimators.wind_ukf import WindUKF
from rotorpy.sensors.external_mocap import MotionCapture
from rotorpy.sensors.imu import Imu
from rotorpy.trajectories.hover_traj import HoverTraj
from rotorpy.vehicles.hummingbird_params import quad_params
from rotorpy.vehicles.multirotor import Multirotor
from rotorpy.wind.default_winds import SinusoidWind
from scipy.spatial.transform import Rotation

from faultpath.system import ComposedSystem, FunctionPlant, Measure, Metric, tapped, writes

DT_S, STEPS, CALIBRATED_AT = 0.01, 500, 3.0  # s, steps, m/s
SPREAD = {"mass": 0.25, "c_Dx": 1.0, "c_Dz": 1.0, "k_d": 0.5, "k_z": 0.5, "k_eta": 0.09}


def wind_ukf():
    ukf = WindUKF(quad_params, dt=DT_S)
    seen = tapped(ukf, "mass", c_Dx="drag", c_Dy="drag", c_Dz="drag_z", at="filter")
    ukf.filter.fx, ukf.filter.hx = seen.f, seen.h  # these were bound to what is not tapped
    return SimpleNamespace(ukf=seen, waiting=[])


@writes("estimate", of=wind_ukf, past="command")
def filter(objects, mocap, imu, rates, command):
    pose = dict(zip("xvqw", np.split(mocap, [3, 6, 10]), strict=True))
    objects.waiting.append(({"w": rates}, pose))
    if command.any():  # in their loop the first step comes after the first command
        for truth, pose in objects.waiting:
            objects.ukf.step(truth, {"cmd_thrust": command[0]}, {"accel": imu}, pose)
        objects.waiting.clear()
    return objects.ukf.filter.x


@writes("push", of=SimpleNamespace)
def feedforward(_, estimate, mass, drag, drag_z):
    air = estimate[6:] - estimate[3:6]  # both in the body's frame
    force = np.array([drag, drag, drag_z]) * air * np.linalg.norm(air)
    return Rotation.from_euler("zyx", estimate[:3]).apply(force / mass)


def se3_control():
    return tapped(SE3Control(quad_params), "mass", "k_eta", at="controller")


@writes("command", of=se3_control, before=np.zeros(5))
def controller(se3, mocap, push):
    pose = dict(zip("xvqw", np.split(mocap, [3, 6, 10]), strict=True))
    sent = se3.update(0.0, pose, HoverTraj().update(0.0) | {"x_ddot": -push})
    return np.append(sent["cmd_thrust"], sent["cmd_motor_speeds"])


# --- scenes ---
def start(rng):
    """Draw a vehicle and its wind, and tell what a calibration in flight would find."""
    own = quad_params | {n: quad_params[n] * rng.uniform(1 - s, 1 + s) for n, s in SPREAD.items()}
    own["c_Dy"], spin = own["c_Dx"], np.sqrt(own["mass"] * 9.81 / (4 * own["k_eta"]))
    wind = SinusoidWind(*rng.uniform([[-3], [0.02], [0]], [[3], [0.1], [50]], (3, 3)))
    state = dict.fromkeys("xvw", np.zeros(3)) | {"q": np.array([0.0, 0.0, 0.0, 1.0])}
    state |= {"wind": wind.update(0.0, state["x"]), "rotor_speeds": np.full(4, spin)}
    known = {"mass": own["mass"], "k_eta": own["k_eta"], "imu": np.zeros(3)}
    for name, frame, rotor in (("drag", "c_Dx", "k_d"), ("drag_z", "c_Dz", "k_z")):
        known[name] = own[frame] + 4 * spin * own[rotor] / CALIBRATED_AT
    known["mocap"] = MotionCapture(1 / DT_S).measurement(state)
    return known | {"time_s": 0.0, "vehicle": Multirotor(own), "wind": wind, "state": state}


def step(scene, command, rng):
    """Read the accelerometer and let the vehicle fly on, in the order of their `simulate`."""
    vehicle, state, sent = scene["vehicle"], scene["state"], {"cmd_motor_speeds": command[1:]}
    stream, time_s = np.random.get_state(), scene["time_s"] + DT_S
    np.random.seed(rng.integers(2**32))  # theirs draw from the global stream
    moved = vehicle.statedot(state, sent, DT_S)
    imu = Imu(sampling_rate=1 / DT_S).measurement(state, moved)["accel"]
    state = vehicle.step(state | {"wind": scene["wind"].update(time_s, state["x"])}, sent, DT_S)
    mocap = MotionCapture(1 / DT_S).measurement(state, with_noise=True)
    np.random.set_state(stream)
    return scene | {"time_s": time_s, "state": state, "mocap": mocap, "imu": imu}


def offset_m(episode):
    return np.sqrt((episode["place"][STEPS // 2 :] ** 2).sum(axis=1).mean())


# --- system ---
def create() -> ComposedSystem:
    known = {"mass": "kg", "k_eta": "N s^2", "drag": "N s^2/m^2", "drag_z": "N s^2/m^2"}
    observes = {n: n for n in (*known, "imu")} | {"rates": ("state", "w"), "place": ("state", "x")}
    observes["mocap"] = lambda scene: np.hstack([scene["mocap"][part] for part in "xvqw"])
    plant = FunctionPlant(
        start,
        step,
        observes=observes,
        action="command",
        steps=STEPS,
        dt_s=DT_S,
        succeeded=lambda episode: offset_m(episode) <= 0.2,
        metrics={"offset_m": Measure(Metric(unit="m", better="less"), offset_m)},
        trace=lambda scene: scene["state"]["x"],
    )
    units = {name: {"unit": unit, "provenance": "estimated"} for name, unit in known.items()}
    units |= {"mocap": "m, m/s, 1, rad/s", "rates": "rad/s", "imu": "m/s^2", "place": "m"}
    units |= {"estimate": "rad, m/s", "push": "m/s^2", "command": "N, rad/s"}
    alone, fed = [controller.given(push=np.zeros(3))], [filter, feedforward, controller]
    return ComposedSystem("rotorpy", plant, {"alone": alone, "fed-forward": fed}, units)
