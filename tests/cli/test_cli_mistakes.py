"""Every mistake ends in one sentence that says what there is, with status 2, and harms nothing."""

from pathlib import Path

import pytest
from cli_runs import HERE, TOY, audit, faultpath

SLOW_TOY = f"{HERE / 'systems' / 'slow_toy.py'}"


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "")


TOY_MISTAKES = {
    "unknown system": ({"system": "quadcopter"}, ["'quadcopter'", "installed: quadrotor"]),
    "unknown module": ({"system": "no_such_module:create"}, ["'no_such_module'"]),
    "unknown file": ({"system": "nowhere/toy.py:create"}, ["nowhere/toy.py"]),
    "unknown function": ({"system": TOY.replace(":create", ":make")}, ["'make'"]),
    "no system": ({"system": TOY.replace(":create", ":Source")}, ["toy.py"]),
    "baseline": ({"baseline": "calibratd"}, ["'calibratd'", "did you mean", "blind, calibrated"]),
    "repair": ({"repair": "x"}, ["'x'", "blind, calibrated"]),
    "both the same": ({"repair": "calibrated"}, ["both 'calibrated'"]),
    "channel": ({"fault": "gian:scale=2"}, ["'gian'", "did you mean 'gain'", "velocity"]),
    "kind": ({"fault": "gain:scal=2"}, ["'scal'", "did you mean 'scale'"]),
    "preset": ({"fault": "calibration=0.1"}, ["'calibration'", "known: none"]),
    "consumer": ({"fault": "gain:scale=2@planner"}, ["'planner'", "controller.inverse"]),
    "consumer of another": (
        {"fault": "gain:scale=2@controller.feedback"},
        ["'controller.feedback' does not read it", "observer.model"],
    ),
    "text": ({"fault": "gain:scale=abc"}, ["a number, not 'abc'"]),
    "NaN": ({"fault": "gain:scale=nan"}, ["finite", "'nan'"]),
    "infinity": ({"fault": "gain:scale=inf"}, ["finite", "'inf'"]),
    "empty": ({"fault": ""}, ["empty"]),
    "no value": ({"fault": "gain:scale"}, ["'scale' needs a value"]),
    "onset": ({"fault": "gain:scale=2,onset=-1"}, ["onset=-1"]),
    "option of a kind": ({"fault": "gain:scale=2,colour=red"}, ["'colour'"]),
    "no scene": ({"scenes": 0}, ["0 scenes", "1 to 100"]),
    "fewer scenes": ({"scenes": -4}, ["-4 scenes", "1 to 100"]),
    "too many scenes": ({"scenes": 101}, ["101 scenes", "1 to 100"]),
    "words for scenes": ({"scenes": "few"}, ["--scenes", "audit --help"]),
    "no seeds": ({"seeds": ""}, ["--seeds ''", "empty"]),
    "half a seed": ({"seeds": "0,1.5"}, ["'0,1.5'", "0,1,2"]),
    "words for seeds": ({"seeds": "a,b"}, ["'a,b'", "0,1,2"]),
    "a seed twice": ({"seeds": "1,2,1"}, ["each of them once"]),
    "workers": ({"workers": -1}, ["-1", "0 (this process) or more"]),
    "setting": ({"set": "gate"}, ["'gate'", "key=value"]),
    "setting without a key": ({"set": "=3"}, ["'=3'", "key=value"]),
    "unknown setting": ({"set": "gate=3"}, ["'gate'", "takes none"]),
    "option of another system": ({"wind": "L1"}, ["--wind", "takes none"]),
    "unknown option": ({"colour": "red"}, ["--colour", "audit --help"]),
}


@pytest.mark.parametrize(("options", "says"), TOY_MISTAKES.values(), ids=TOY_MISTAKES)
def test_a_mistake_about_a_system_of_ones_own(options, says, tmp_path):
    sentence = audit(**options).refused()
    for part in says:
        assert part in sentence
    assert list(tmp_path.iterdir()) == []


def test_a_setting_given_twice_is_refused():
    assert "'a' twice" in audit("--set", "a=1", "--set", "a=2").refused()


QUADROTOR_MISTAKES = {
    "variant": ({"repair": "wind"}, ["'wind'", "did you mean 'zero-wind'", "true-wind"]),
    "wind": ({"wind": "L4"}, ["'L4'", "L0, L1, L2, L3"]),
    "environment": ({"environment": "sea"}, ["'sea'", "obstacles, free-space"]),
    "predictor": ({"predictor": "oracle"}, ["'oracle'", "dki, dki-drag, true-parameter"]),
    "clearance": ({"clearance": "radar"}, ["'radar'", "depth, true"]),
    "planner": ({"planner": "rrt"}, ["'rrt'", "choose one of mppi, cem"]),
    "plant": ({"plant": "gazebo"}, ["'gazebo'", "choose one of torch"]),
    "plant on a GPU": (
        {"plant": "my.py:create", "device": "cuda"},
        ["CPU only", "leave --device out"],
    ),
    "device": ({"device": "tpu"}, ["'tpu'", "cpu, cuda"]),
    "device that is not there": ({"device": "cuda"}, ["needs a GPU", "leave --device out"]),
    "option": ({"set": "colour=red"}, ["'colour'", "wind, environment, clearance, predictor"]),
    "library": ({"library": "heldout"}, ["'heldout'", "training, selection, held-out"]),
    "calibration -1": ({"fault": "calibration=-1"}, ["between -1 and 1"]),
    "calibration -1.5": ({"fault": "calibration=-1.5"}, ["-1.5", "between -1 and 1"]),
    "calibration 1": ({"fault": "calibration=1"}, ["between -1 and 1"]),
    "calibration NaN": ({"fault": "calibration=nan"}, ["finite", "'nan'"]),
    "calibration infinite": ({"fault": "calibration=-inf"}, ["finite", "'-inf'"]),
    "calibration in words": ({"fault": "calibration=abc"}, ["'abc'"]),
    "calibration without size": ({"fault": "calibration"}, ["needs a size", "calibration=+0.1"]),
    "consumer": (
        {"fault": "wind:scale=2@reconstruction"},
        ["does not read it", "predictor.wind_map"],
    ),
    "reaches no consumer": (
        {"repair": "true-wind", "fault": "mass:scale=1.1@reconstruction"},
        ["neither 'zero-wind' nor 'true-wind'"],
    ),
    "scenes": ({"scenes": 101}, ["'held-out'", "1 to 100"]),
}


@pytest.mark.parametrize(("options", "says"), QUADROTOR_MISTAKES.values(), ids=QUADROTOR_MISTAKES)
def test_a_mistake_about_the_quadrotor(options, says, tmp_path):
    asked = {
        "system": "quadrotor",
        "baseline": "zero-wind",
        "repair": "dob",
        "fault": "calibration=0.1",
        "library": "held-out",
    }
    sentence = audit(**(asked | options)).refused()
    for part in says:
        assert part in sentence
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["fly"], ["'fly'", "`faultpath --help`"]),
        (["audit"], ["system", "`faultpath audit --help`"]),
        (["audit", TOY], ["--baseline"]),
        (["report"], ["folders"]),
        (["report", "nowhere"], ["nowhere", "finished run"]),
        (["trace", "nothing"], ["'nothing'", "quadrotor"]),
    ],
    ids=" ".join,
)
def test_a_mistake_about_the_command_itself(arguments, says, tmp_path):
    sentence = faultpath(*arguments).refused()
    for part in says:
        assert part in sentence
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("arguments", [[], ["train"]])
def test_without_a_verb_there_is_help_and_no_traceback(arguments):
    ended = faultpath(*arguments)
    assert ended.status == 2
    assert "Usage" in ended.out
    assert ended.err == ""


YAMLS = {
    "not YAML": ("name: [", "not plain YAML"),
    "nothing": ("", "no interface"),
    "a tag that runs code": (
        "name: !!python/object/apply:os.system ['touch harm']",
        "tags are not read",
    ),
    "aliases": ("name: &a x\nsources: *a\n", "aliases"),
    "deep": ("[" * 200 + "]" * 200, "nested too deeply"),
    "no channels": ("name: toy\nsources: []\n", "channels"),
    "unknown field": ("name: toy\nsources: []\nchannels: []\ncolour: red\n", "colour"),
    "unknown source": (
        "name: toy\nsources: []\nchannels:\n- {name: a, sources: [b], consumers: [m.p]}\n",
        "'b'",
    ),
    "twice": ("name: toy\nname: toy\nsources: []\nchannels: []\n", "appears twice"),
}


@pytest.mark.parametrize(("text", "says"), YAMLS.values(), ids=YAMLS)
def test_a_malformed_or_unsafe_interface_file(text, says, tmp_path):
    (tmp_path / "interface.yaml").write_text(text)
    system = f"{SLOW_TOY}:from_yaml"
    sentence = faultpath("trace", system, "--set", "interface=interface.yaml").refused()
    assert "interface.yaml" in sentence
    assert says in sentence
    assert not (tmp_path / "harm").exists()
