"""opendbc's controllers and firmware, untouched: control is allowed as in a car, by messages."""

from importlib import import_module
from shutil import which

import pytest

pytest.importorskip("opendbc")
pytest.importorskip("cffi")
if which("gcc") is None:
    pytest.skip("gcc, which compiles the firmware, is not here", allow_module_level=True)

from foreign_trials import ROOT, attempted, faulted

from faultpath import audit

EXAMPLES = ("openpilot_speed.py", "openpilot_car.py")
CARS = ("ford", "tesla", "nissan")
SCENE, OTHER = "seed/2", "seed/3"


@pytest.fixture
def example(monkeypatch):
    """The example, with trials that end before the bend."""
    monkeypatch.syspath_prepend(str(ROOT / "examples"))
    module = import_module(EXAMPLES[0].removesuffix(".py"))
    monkeypatch.setattr(module, "STEPS", 80)
    return module


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
    speeds, objects = [], example.objects

    def noted(car):
        made = objects(car)
        apply = made.car.apply

        def note(order, nanos):
            speeds.append(made.car.CS.out.vEgoRaw)
            return apply(order, nanos)

        made.car.apply = note
        return made

    monkeypatch.setattr(example, "objects", noted)
    system, last = example.create("nissan"), {}
    for version in ("shipped", "filtered", "two-messages"):
        attempted(system, version, (SCENE,), "speed:scale=1.2@controller")
        last[version] = speeds[-1]
    rear, all_four = 1.2 * last["two-messages"], 1.1 * last["two-messages"]
    assert last["shipped"] == pytest.approx(rear, rel=0.02)
    assert last["filtered"] == pytest.approx(all_four, rel=0.02)


def test_it_is_audited(example, tmp_path) -> None:
    question = {"baseline": "shipped", "repair": "recovers", "fault": "tyre:scale=1.05"}
    how = {"workers": 0, "signals": False, "folder": tmp_path}
    run = audit(example.create("ford"), **question, scenes=2, library="training", **how)
    assert [condition.name for condition in run.record.conditions] == [
        "correct",
        "controller",
        "firmware",
        "shared",
    ]
    assert sum(effect.void for effect in run.record.effects) == 0


def test_their_code_needs_few_lines_of_glue() -> None:
    lines = (ROOT / "examples" / EXAMPLES[0]).read_text("utf-8").splitlines()
    assert len(lines) <= 150
    assert len(lines[lines.index("    # --- glue ---") + 1 :]) <= 15
