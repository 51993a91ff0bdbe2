"""Audits in which some scenes never read the faulted channel while the fault is in force."""

from typing import Any

import pytest

import faultpath
from faultpath.loop import NotDelivered
from faultpath.system import ComposedSystem, FunctionPlant, tapped, writes

FAULT = "gain:scale=0.5,onset=5,for=3"


def drive() -> dict[str, float]:
    return tapped({"gain": 1.0}, "gain", at="controller")


def reads_at(steps: range) -> ComposedSystem:
    """Return a system whose controller reads the gain at one step, which is drawn from `steps`."""

    @writes("push", of=drive)
    def controller(gains: Any, place: Any, reads: Any) -> Any:
        return -place / gains["gain"] if reads else -place

    plant = FunctionPlant(
        lambda rng: {"place": rng.uniform(-1, 1), "t": 0, "at": rng.choice(steps), "gain": 1.1},
        lambda state, push, rng: state | {"place": state["place"] + push / 9, "t": state["t"] + 1},
        observes={
            "place": "place",
            "reads": lambda state: 1.0 * (state["t"] == state["at"]),
            "gain": "gain",
        },
        action="push",
        steps=15,
        dt_s=0.1,
        succeeded=lambda episode: abs(episode["place"][-1]) < 0.1,
    )
    units = {"place": "m", "reads": "1", "gain": "1", "push": "m/s"}
    variants = {"old": [controller], "new": [controller]}
    return ComposedSystem("seldom", plant, variants, units)


def audited(steps: range, folder: Any, **options: Any) -> faultpath.Run:
    return faultpath.audit(
        reads_at(steps),
        baseline="old",
        repair="new",
        fault=FAULT,
        library="training",
        folder=folder,
        workers=0,
        progress=False,
        **options,
    )


@pytest.mark.parametrize("options", [{"scenes": 20}, {"scenes": 40, "stop_when": "decided"}])
def test_scenes_that_a_fault_misses_are_no_mistake_in_any_block(tmp_path, options):
    run = audited(range(15), tmp_path, **options)  # it reaches one scene in five
    assert (run.record.invalid, run.record.findings) == (None, ())
    effect = run.record.effects[-1]
    assert effect.condition == "controller"
    assert effect.scenes == options["scenes"]


def test_a_fault_that_misses_all_scenes_is_a_mistake(tmp_path):
    sentence = r"gain -> controller\.gain: .* never reached it, although 20 of 20 scenes ran"
    with pytest.raises(NotDelivered, match=sentence):
        audited(range(9, 15), tmp_path, scenes=20)
