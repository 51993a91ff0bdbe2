"""The car of `openpilot_speed.py`: its road, its motion by opendbc's model, and its messages.

Each scene is a road with one bend, driven for 7 s at a speed that swings by 8 %. A camera that
never errs gives the curvature to drive; the car measures its speed twice, with noise of its own.
"""

from functools import cache
from importlib import import_module
from math import degrees, radians, sin

import numpy as np
from opendbc.car.vehicle_model import VehicleModel, create_dyn_state_matrices

DT_S, STEPS, CRUISE, STEERS, LETS_GO = 0.01, 700, 20, 30, 25  # s; steps, and when these begin
CARS = {  # platform, greatest speed (m/s), greatest pull in a bend (m/s^2), shortest entry (s)
    "tesla": ("TESLA_MODEL_Y", 32.0, 3.4, 0.6),
    "nissan": ("NISSAN_XTRAIL", 14.0, 2.8, 0.8),
    "ford": ("FORD_ESCAPE_MK4", 28.0, 2.6, 0.8),
}


@cache
def known(car):
    """Return their interface for a car, its parameters and its vehicle model."""
    interface = import_module(f"opendbc.car.{car}.interface").CarInterface
    params = interface.get_non_essential_params(CARS[car][0])
    return interface, params, VehicleModel(params)


def curvature(state):
    """Return the curvature of the road at a place: one bend that winds up, holds, unwinds."""
    entry, hold, bend = state["entry"], state["hold"], state["bend"]
    in_bend = state["place"] - state["cruise"]  # it begins after a second at cruising speed
    shape = min(in_bend, 2 * entry + hold - in_bend) / entry
    return min(max(shape, 0.0), 1.0) * bend


def start(rng, car):
    _, fastest, pull, entry = CARS[car]
    cruise = rng.uniform(0.5, 1.0) * fastest
    state = dict.fromkeys(("place", "offset", "heading", "slip", "yaw", "wheel", "target"), 0.0)
    state |= {"cruise": cruise, "period": rng.uniform(3, 10), "phase": rng.uniform(0, 6.28)}
    state |= {"entry": rng.uniform(entry, entry + 1.2) * cruise, "hold": rng.uniform(1, 2) * cruise}
    state["bend"] = rng.choice([-1, 1]) * rng.uniform(0.5, 1.0) * pull / cruise**2
    return measured(state | {"i": 0, "quiet": 0, "orders": 0, "blocked": 0}, rng, car)


def measured(state, rng, car):
    """Return the state with what the car measures: its speed twice, the wheel and the lane."""
    swing = sin(6.28 * state["i"] * DT_S / state["period"] + state["phase"])
    moves = state["cruise"] * (1 + 0.08 * swing)
    speed, speed_2 = moves + rng.normal(scale=0.05, size=2)
    ahead = moves * (known(car)[1].steerActuatorDelay + 0.05)
    plan = curvature(state | {"place": state["place"] + ahead})
    plan -= state["offset"] / moves**2 + 1.8 * state["heading"] / moves
    read = {"speed": speed, "speed_2": speed_2, "angle": degrees(state["wheel"]), "plan": plan}
    return state | read | {"moves": moves}


def step(state, sent, rng, car):
    """Move the car on; an order that was blocked never arrives, and without any it lets go."""
    (passed, order), (_, params, model), s = sent, known(car), dict(state)
    s["orders"] += s["i"] > STEERS and passed != 0
    s["blocked"] += s["i"] > STEERS and passed < 0
    s["quiet"] = 0 if passed > 0 else s["quiet"] + 1
    if passed > 0 and car == "ford":  # orders a curvature, all others the angle of the wheel
        s["target"] = model.get_steer_from_curvature(order, s["moves"], 0.0)
    elif passed > 0:
        s["target"] = radians(order)
    elif s["quiet"] > LETS_GO:
        s["target"] = 0.0
    s["wheel"] += (s["target"] - s["wheel"]) * DT_S / params.steerActuatorDelay
    a, b = create_dyn_state_matrices(s["moves"], model)
    turn = np.array([s["slip"], s["yaw"]])
    s["slip"], s["yaw"] = turn + DT_S * (a @ turn + b[:, 0] * s["wheel"])
    s["offset"] += DT_S * (s["slip"] + s["moves"] * sin(s["heading"]))
    s["heading"] += DT_S * (s["yaw"] - curvature(s) * s["moves"])
    s["place"] += DT_S * s["moves"]
    s["i"] += 1
    return measured(s, rng, car)


# --- messages of a car: period in steps, bus, name, values ---
def tesla(i, v, v_2, yaw, angle):
    yield 2, 0, "DI_speed", {"DI_vehicleSpeed": v}
    yield 2, 0, "ESP_B", {"ESP_vehicleSpeed": v_2, "ESP_wheelSpeedsQF": 1}
    yield 1, 0, "EPAS3S_sysStatus", {"EPAS3S_internalSAS": -angle, "EPAS3S_eacStatus": 2}
    yield 10, 0, "DI_state", {"DI_cruiseState": 1 + (i >= CRUISE)}
    yield 10, 0, "ESP_status", {"ESP_driverBrakeApply": 1}
    yield from ((10, 0, name, {}) for name in ("DI_systemStatus", "UI_warning"))
    yield from ((10, 2, name, {}) for name in ("DAS_control", "DAS_steeringControl"))


def nissan(i, v, v_2, yaw, angle):
    yield 2, 0, "WHEEL_SPEEDS_REAR", {"WHEEL_SPEED_RL": v, "WHEEL_SPEED_RR": v}
    yield 2, 0, "WHEEL_SPEEDS_FRONT", {"WHEEL_SPEED_FL": v_2, "WHEEL_SPEED_FR": v_2}
    yield 1, 0, "STEER_ANGLE_SENSOR", {"STEER_ANGLE": angle}
    yield 10, 2, "CRUISE_STATE", {"CRUISE_ENABLED": i >= CRUISE}
    yield from ((10, 0, name, {}) for name in ("GAS_PEDAL", "DOORS_LIGHTS"))


def ford(i, v, v_2, yaw, angle):
    counts, turns = {"VehVActlBrk_No_Cnt": i // 2 % 16}, {"VehRollYaw_No_Cnt": i % 256}
    yield 2, 0, "BrakeSysFeatures", counts | {"Veh_V_ActlBrk": v, "VehVActlBrk_D_Qf": 3}
    yield 2, 0, "EngVehicleSpThrottle2", {"Veh_V_ActlEng": v_2, "VehVActlEng_D_Qf": 3}
    yield 1, 0, "Yaw_Data_FD1", turns | {"VehYaw_W_Actl": yaw, "VehYawWActl_D_Qf": 3}
    yield 10, 0, "EngBrakeData", {"CcStat_D_Actl": 3 + 2 * (i >= CRUISE)}
    yield from ((10, 0, name, {}) for name in ("EngVehicleSpThrottle", "DesiredTorqBrk"))


STEERING = {  # the message that steers, its signal, and the sign that means left
    "tesla": (tesla, "DAS_steeringControl", "DAS_steeringAngleRequest", -1.0),
    "nissan": (nissan, "LKAS", "DESIRED_ANGLE", 1.0),
    "ford": (ford, "LateralMotionControl", "LatCtlCurv_No_Actl", 1.0),
}
