"""opendbc's controllers and firmware, untouched: control is allowed as in a car, by messages."""

import inspect
from importlib import import_module
from math import degrees
from shutil import which

import pytest

pytest.importorskip("opendbc")
pytest.importorskip("cffi")
if which("gcc") is None:
    pytest.skip("gcc, which compiles the firmware, is not here", allow_module_level=True)

from foreign_trials import ROOT, attempted, faulted, imported, lines
from opendbc.can import CANPacker
from opendbc.can.parser import get_raw_value
from opendbc.car import structs
from opendbc.safety.tests.libsafety.libsafety_py import ffi, make_CANPacket
from opendbc.safety.tests.test_ford import checksum

from faultpath import generator

EXAMPLES = ("openpilot_speed.py", "openpilot_car.py")
CARS = ("ford", "tesla", "nissan")
SCENE, OTHER = "seed/2", "seed/3"


@pytest.fixture
def example(monkeypatch):
    """The example, with trials that end before the bend."""
    return imported(monkeypatch, EXAMPLES[0], STEPS=80)


class Drive:
    """What somebody writes without faultpath: the same objects and calls, and nothing of ours."""

    def __init__(self, example, car):
        interface, params, self.model = example.known(car)
        self.messages, name, signal, self.left = example.STEERING[car]
        self.car = interface(params)
        self.packer = CANPacker(next(iter(self.car.can_parsers.values())).dbc_name)
        steer = self.packer.dbc.name_to_msg[name]
        self.address, self.signal = steer.address, steer.sigs[signal]
        self.panda = ffi.dlopen(str(example.compiled()))
        config = params.safetyConfigs[-1]
        self.panda.set_safety_hooks(config.safetyModel.raw, config.safetyParam)
        self.i, self.plan, self.passed = -1, 0.0, 0.0

    def step(self, speed, speed_2, yaw, angle, plan, version):
        self.i += 1
        due = self.messages(self.i, speed * 3.6, speed_2 * 3.6, yaw, angle)
        due = [(name, at, values) for period, at, name, values in due if self.i % period == 0]
        sent = [checksum(self.packer.make_can_msg(*message)) for message in due]
        state = self.car.update([(self.i * 10**7, sent)])
        if version == "filtered":
            state.vEgoRaw = state.vEgo
        elif version == "two-messages":
            state.vEgo = state.vEgoRaw = round(float(speed_2) * 7.2) / 7.2
        elif version == "recovers" and self.passed < 0:
            self.car.CC.apply_angle_last = state.steeringAngleDeg
            self.car.CC.apply_curvature_last = 0.0
        most, change = 3.0 / max(state.vEgo, 1.0) ** 2, 5.0 / max(state.vEgo, 1.0) ** 2 * 0.01
        self.plan = max(min(float(plan), self.plan + change, most), self.plan - change, -most)
        order = structs.CarControl()
        order.enabled = order.latActive = self.i >= 30
        order.actuators.curvature = -self.plan
        wheel = self.model.get_steer_from_curvature(self.plan, state.vEgo, 0.0)
        order.actuators.steeringAngleDeg = degrees(wheel)
        sends = self.car.apply(order.as_reader(), self.i * 10**7)[1]
        data = next((data for address, data, _ in sends if address == self.address), None)
        self.panda.set_timer((self.i + 1) * 10**4)
        for address, received, at in sent:
            self.panda.safety_rx_hook(make_CANPacket(address, at, received))
        if self.i % 100 == 99:
            self.panda.safety_tick_current_safety_config()
        self.passed, value = 0.0, 0.0
        if data:
            self.passed = 2.0 * self.panda.safety_tx_hook(make_CANPacket(self.address, 0, data)) - 1
            value = get_raw_value(data, self.signal) * self.signal.factor + self.signal.offset
        return self.passed, self.left * value


@pytest.mark.parametrize(
    ("car", "version"), [("ford", "recovers"), ("tesla", "two-messages"), ("nissan", "filtered")]
)
def test_without_a_fault_it_drives_as_a_plain_loop_to_the_bit(example, car, version) -> None:
    example.STEPS = 300
    (outcome,) = attempted(example.create(car), version, (SCENE,)).outcomes
    state = example.start(generator("plant/start", SCENE, 0), car)
    drive, offsets = Drive(example, car), [state["offset"]]
    for i in range(example.STEPS):
        reads = (state[name] for name in ("speed", "speed_2", "yaw", "angle", "plan"))
        sent = drive.step(*reads, version)
        state = example.step(state, sent, generator("plant/step", SCENE, 0, i), car)
        offsets.append(state["offset"])
    assert outcome.metrics["off_m"] == max(map(abs, offsets)) > 0


def blocked(system, fault=""):
    (outcome,) = attempted(system, "shipped", (SCENE,), fault).outcomes
    return outcome.metrics["blocked"]


@pytest.mark.parametrize("car", CARS)
def test_the_firmware_passes_what_the_car_lets_it_pass(example, monkeypatch, car) -> None:
    system = example.create(car)
    assert blocked(system) == 0
    apart = blocked(system, "speed_2:offset=2.5@firmware")
    assert apart == (0 if car == "nissan" else 100)  # theirs for the Nissan reads one speed
    monkeypatch.setattr(import_module("openpilot_car"), "CRUISE", 1000)
    assert blocked(system) == 100


@pytest.mark.parametrize("struck", ["controller", "firmware"])
def test_a_fault_at_one_reader_changes_what_that_reader_gets(example, monkeypatch, struck) -> None:
    system, reads, arrived = example.create("ford"), [], example.arrived

    def noted(o, speed, speed_2, yaw, angle):
        reads.append((float(speed), float(speed_2)))
        return arrived(o, speed, speed_2, yaw, angle)

    monkeypatch.setattr(example, "arrived", noted)
    trial = attempted(system, "shipped", (SCENE,), f"tyre:scale=1.05@{struck}")
    pairs = list(zip(reads[::2], reads[1::2], strict=True))  # controller, then firmware
    assert len(pairs) == example.STEPS
    for at_controller, at_firmware in pairs:
        wrong, right = at_controller, at_firmware
        if struck == "firmware":
            wrong, right = right, wrong
        assert wrong == tuple(1.05 * speed for speed in right)
    assert set(faulted(trial)) == {f"{struck}.speed", f"{struck}.speed_2"}


def test_each_scene_has_a_firmware_of_its_own(example) -> None:
    example.STEPS = 300
    system, fault = example.create("ford"), "tyre:scale=1.2@firmware"
    together = attempted(system, "recovers", (SCENE, OTHER), fault).outcomes
    alone = [attempted(system, "recovers", (name,), fault).outcomes[0] for name in (SCENE, OTHER)]
    assert [outcome.metrics for outcome in together] == [outcome.metrics for outcome in alone]


def test_each_version_limits_by_the_speed_that_it_is_named_for(example, monkeypatch) -> None:
    speeds, (interface, _, _) = [], example.known("nissan")
    apply = interface.apply

    def note(car, order, nanos):
        speeds.append(car.CS.out.vEgoRaw)
        return apply(car, order, nanos)

    monkeypatch.setattr(interface, "apply", note)
    system, last = example.create("nissan"), {}
    for version in ("shipped", "filtered", "two-messages"):
        attempted(system, version, (SCENE,), "speed:scale=1.2@controller")
        last[version] = speeds[-1]
    rear, all_four = 1.2 * last["two-messages"], 1.1 * last["two-messages"]
    assert last["shipped"] == pytest.approx(rear, rel=0.02)
    assert last["filtered"] == pytest.approx(all_four, rel=0.02)


def test_faultpath_takes_few_lines_beside_a_plain_loop() -> None:
    text = (ROOT / "examples" / EXAMPLES[0]).read_text("utf-8")
    modules = text.partition("\ndef objects")[2].partition("\nSEEDS")[0]
    glue = text.partition("# --- glue ---")[2]
    ours, theirs = lines(f"def objects{modules}{glue}"), lines(inspect.getsource(Drive))
    assert 0 < ours - theirs <= 15
    page = " ".join((ROOT / "docs" / "openpilot.md").read_text("utf-8").split())
    assert f"the same calls takes {theirs} lines of code, and drives alike" in page
    assert f"The example takes {ours}" in page
