"""Cars' steering controllers and their safety firmware, both as opendbc 0.3.1 ships them.

`CarController` (Python) limits its steering by the car's speed. panda's firmware (C) reads the same
messages, has limits of its own, and blocks what exceeds them. No file of theirs is changed. The
firmware limits by `speed` and checks it against `speed_2`; where these come from differs by car.

    faultpath audit examples/openpilot_speed.py:create --car ford --baseline shipped \
        --repair recovers --fault tyre:scale=1.05 --scenes 150
"""

from functools import cache, partial
from math import degrees
from pathlib import Path
from shutil import copy
from subprocess import run
from tempfile import NamedTemporaryFile, mkdtemp
from types import SimpleNamespace
from typing import Annotated, Literal

import opendbc
from opendbc.can import CANPacker
from opendbc.can.parser import get_raw_value
from opendbc.car import structs
from opendbc.car.carlog import carlog
from opendbc.safety.tests.libsafety.libsafety_py import ffi, make_CANPacket
from opendbc.safety.tests.test_ford import checksum
from openpilot_car import DT_S, STEERING, STEERS, STEPS, known, start, step

from faultpath.system import ComposedSystem, FunctionPlant, Measure, Metric, Parts, writes

carlog.setLevel("ERROR")  # else it warns of messages that nothing here uses
SHIM = """
#include "opendbc/safety/tests/libsafety/fake_stm.h"
#include "opendbc/safety/can.h"
#include "opendbc/safety/safety.h"
void set_timer(uint32_t t) { timer_cnt = t; }
void safety_tick_current_safety_config(void) { safety_tick(&current_safety_config); }
"""


# --- their objects ---
@cache
def compiled():
    built = Path(mkdtemp(prefix="openpilot-")) / "firmware.so"
    words = ["gcc", "-shared", "-fPIC", "-O1", "-xc", "-I", Path(opendbc.__file__).parents[1]]
    run([*words, "-", "-o", built], input=SHIM.encode(), check=True)
    return built


def objects(car):
    (interface, params, model), (messages, name, signal, left) = known(car), STEERING[car]
    own = interface(params)
    packer = CANPacker(next(iter(own.can_parsers.values())).dbc_name)
    steer = packer.dbc.name_to_msg[name]
    with NamedTemporaryFile(suffix=".so") as library:  # its state is global: a copy for each scene
        panda = ffi.dlopen(copy(compiled(), library.name))
    config = params.safetyConfigs[-1]
    panda.set_safety_hooks(config.safetyModel.raw, config.safetyParam)
    o = SimpleNamespace(car=own, packer=packer, messages=messages, model=model, i=-1, plan=0.0)
    o.panda, o.address, o.signal, o.left = panda, steer.address, steer.sigs[signal], left
    return o


def arrived(o, speed, speed_2, yaw, angle):
    """Return the messages that the car sends in the next 10 ms."""
    o.i += 1
    due = o.messages(o.i, speed * 3.6, speed_2 * 3.6, yaw, angle)
    return [checksum(o.packer.make_can_msg(n, at, v)) for p, at, n, v in due if o.i % p == 0]


# --- modules ---
@writes("message", of=objects, past="sent")
def controller(o, speed, speed_2, yaw, angle, plan, sent, version):
    """Let their controller answer the car; return the steering message that it sends, if any."""
    state = o.car.update([(o.i * 10**7, arrived(o, speed, speed_2, yaw, angle))])
    if version == "filtered":
        state.vEgoRaw = state.vEgo
    elif version == "two-messages":
        state.vEgo = state.vEgoRaw = round(float(speed_2) * 7.2) / 7.2  # as ESP_B: 0.5 km/h
    elif version == "recovers" and sent[0] < 0:  # blocked: begin anew where the firmware does
        o.car.CC.apply_angle_last, o.car.CC.apply_curvature_last = state.steeringAngleDeg, 0.0
    most, change = 3.0 / max(state.vEgo, 1.0) ** 2, 5.0 / max(state.vEgo, 1.0) ** 2 * DT_S
    o.plan = max(min(float(plan), o.plan + change, most), o.plan - change, -most)
    order = structs.CarControl()
    order.enabled = order.latActive = o.i >= STEERS
    order.actuators.curvature = -o.plan
    wheel = o.model.get_steer_from_curvature(o.plan, state.vEgo, 0.0)
    order.actuators.steeringAngleDeg = degrees(wheel)
    sends = o.car.apply(order.as_reader(), o.i * 10**7)[1]
    data = next((data for address, data, _ in sends if address == o.address), b"")
    return [len(data), *data.ljust(8, b"\0")]


@writes("sent", of=objects, before=(0.0, 0.0))
def firmware(o, speed, speed_2, yaw, angle, message, version):
    """Let their firmware pass or block a message; return 1 or -1 and the order, 0 without one."""
    less = 0.75 if version == "narrow" else 0.0  # m/s, of the 1 m/s in its code
    o.panda.set_timer((o.i + 1) * 10**4)
    for address, data, at in arrived(o, speed + less, speed_2 + less, yaw, angle):
        o.panda.safety_rx_hook(make_CANPacket(address, at, data))
    if o.i % 100 == 99:
        o.panda.safety_tick_current_safety_config()
    if not message[0]:
        return 0.0, 0.0
    data = bytes(map(int, message[1 : 1 + int(message[0])]))
    passes = o.panda.safety_tx_hook(make_CANPacket(o.address, 0, data))
    order = get_raw_value(data, o.signal) * o.signal.factor + o.signal.offset
    return 2.0 * passes - 1.0, o.left * order


SEEDS = {"training": range(100), "held-out": range(1000, 1200)}
VERSIONS = {
    "shipped": "Controller and firmware as they are.",
    "filtered": "The controller limits by its filtered speed.",
    "two-messages": "The controller reads speed_2, the firmware speed.",
    "recovers": "After a blocked message the controller begins anew.",
    "narrow": "The firmware tolerates a difference of 0.25 m/s in place of 1.",
}


def blocked(episode):
    return 100 * episode["blocked"][-1] / max(episode["orders"][-1], 1)


def create(
    car: Annotated[Literal["tesla", "nissan", "ford"], "Whose car it is."] = "ford",
) -> ComposedSystem:
    speed = {"unit": "m/s", "correlation_group": "tyre"}
    units = {"speed": speed, "speed_2": speed, "yaw": "rad/s", "angle": "deg", "plan": "1/m"}
    units |= {"offset": "m", "blocked": "1", "orders": "1"}
    off_m = Measure(Metric(unit="m", better="less"), lambda e: abs(e["offset"]).max())
    plant = FunctionPlant(
        partial(start, car=car),
        partial(step, car=car),
        observes={name: name for name in units},
        action="sent",
        steps=STEPS,
        dt_s=DT_S,
        succeeded=lambda episode: bool(off_m.of(episode) <= 0.5),
        over=lambda state: abs(state["offset"]) > 1.8,
        metrics={"blocked": Measure(Metric(unit="%", better="less"), blocked), "off_m": off_m},
    )
    # --- glue ---
    variants = {
        name: Parts(text, [part.given(car=car, version=name) for part in (controller, firmware)])
        for name, text in VERSIONS.items()
    }
    units |= dict.fromkeys(("message", "sent"), "1")
    return ComposedSystem(f"openpilot_{car}", plant, variants, units, scenes=SEEDS)
