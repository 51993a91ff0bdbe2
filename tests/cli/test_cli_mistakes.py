"""Every mistake ends in one sentence that names what is wrong, with status 2, and harms nothing."""

import pytest
from cli_runs import TOY, audit, faultpath
from pydantic import TypeAdapter
from written import written

from faultpath.core.errors import UserError
from faultpath.run.question import CheckQuestion, ask
from faultpath.run.texts import Seeds

TOY_MISTAKES = {
    "baseline": ({"baseline": "calibratd"}, ["'calibratd'", "did you mean", "blind, calibrated"]),
    "stop at a word": ({"stop-when": "x"}, ["invalid value for '--stop-when': 'x' is not one of"]),
    "words for scenes": ({"scenes": "few"}, ["--scenes", "audit --help"]),
    "scenes in other digits": ({"scenes": "٣"}, ["--scenes", "'٣'", "a whole number"]),
    "scenes as Python writes it": ({"scenes": "2_0"}, ["--scenes", "'2_0'", "a whole number"]),
    "margin as Python writes it": ({"margin": "1_0"}, ["--margin", "'1_0'", "a number"]),
    "lost time limit": ({"time-limit": "1e-400"}, ["--time-limit", "'1e-400'", "round"]),
    "lost threshold": ({"thresholds": "0.1,1e-400"}, ["--thresholds", "1e-400", "round"]),
    "half a seed": ({"seeds": "0,1.5"}, ["--seeds", "'0,1.5'", "0,1,2"]),
    "long seed": ({"seeds": "9" * 4000}, ["--seeds"]),
    "more workers than any machine has": ({"workers": "9" * 30}, ["at most"]),
    "setting": ({"set": "gate"}, ["'gate'", "key=value"]),
    "setting without a key": ({"set": "=3"}, ["'=3'", "key=value"]),
    "unknown option": ({"colour": "red"}, ["--colour", "audit --help"]),
    "page of no variant": ({"fail-if": "reversed"}, ["--fail-if", "'reversed'", "'reversal'"]),
    "empty": ({"metric": ""}, ["--metric", "empty"]),
    "empty list": ({"thresholds": ""}, ["--thresholds", "empty"]),
}


@pytest.mark.parametrize(("options", "names"), TOY_MISTAKES.values(), ids=TOY_MISTAKES)
def test_a_mistake_about_a_system_of_ones_own(options, names, tmp_path):
    audit(**options).refused(*names)
    assert list(tmp_path.iterdir()) == []


QUADROTOR_MISTAKES = {
    "variant": ({"repair": "wind"}, ["'wind'", "did you mean 'zero-wind'", "true-wind"]),
    "wind": ({"wind": "L4"}, ["'L4'", "L0, L1, L2, L3"]),
    "environment": ({"environment": "sea"}, ["'sea'", "obstacles, free-space"]),
    "predictor": ({"predictor": "oracle"}, ["'oracle'", "dki, dki-drag, true-parameter"]),
    "clearance": ({"clearance": "radar"}, ["'radar'", "depth, true"]),
    "planner": ({"planner": "rrt"}, ["'rrt'", "mppi, cem"]),
    "plant": ({"plant": "gazebo"}, ["'gazebo'", "torch"]),
    "plant on a GPU": ({"plant": "my.py:create", "device": "cuda"}, ["CPU", "--device"]),
    "device": ({"device": "tpu"}, ["'tpu'", "cpu, cuda"]),
    "device that is not there": ({"device": "cuda"}, ["GPU", "--device"]),
    "calibration -1": ({"fault": "calibration=-1"}, ["between -1 and 1"]),
    "calibration without size": ({"fault": "calibration"}, ["size", "calibration=+0.1"]),
    "reader": ({"fault": "wind:scale=2@reconstruction"}, ["predictor.wind_map"]),
}


@pytest.mark.parametrize(("options", "names"), QUADROTOR_MISTAKES.values(), ids=QUADROTOR_MISTAKES)
def test_a_mistake_about_the_quadrotor(options, names, tmp_path, monkeypatch):
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "")
    variants = {"baseline": "zero-wind", "repair": "dob", "fault": "calibration=0.1"}
    audit(**{"system": "quadrotor", "library": "held-out", **variants, **options}).refused(*names)
    assert list(tmp_path.iterdir()) == []


LINES = [
    (["adit"], ["no such command 'adit', did you mean 'audit'?"]),
    (["fly"], ["'fly'", "`faultpath --help`"]),
    (["audit"], ["system", "`faultpath audit --help`"]),
    (["audit", TOY], ["--baseline"]),
    (["audit", TOY, "--out"], ["'--out' requires an argument", "`faultpath audit --help`"]),
    (["report", "nowhere"], ["nowhere"]),
    (["report", "a\u2028b"], ["\\u2028"]),
    (["report", ".", "--out", "a.html"], ["--out", "two or more"]),
    (["trace", "a\x1b[31mb.py:create"], ["\\x1b[31m"]),
    (["trace", TOY, "--seed", "9" * 30], ["--seed"]),
    (["trace", TOY, "--library", "selection"], ["unknown library 'selection'", "known: carts"]),
    (["check", TOY, "--library", "held-out"], ["unknown library 'held-out'", "known: carts"]),
    (["audit", TOY, "--library="], ["--library=", "empty"]),
    (["audit", TOY, "--library=a", "--library", "a"], ["--library", "twice"]),
    (["reproduce", "table-9"], ["'table-9'", "table-1, table-2"]),
    (["reproduce", "--profile", "huge"], ["'huge'", "quick, paper"]),
    (["reproduce", "table-4", "--device", "tpu"], ["'tpu'", "cpu, cuda"]),
    (["reproduce", "x" * 5000], ["too long"]),
    (["reproduce", "\udcff"], ["UTF-8"]),
    (["reproduce", "table-4", "--judge", "--workers", "2"], ["--pages", "--workers", "--judge"]),
    (["train", "quadrotor", "--seed", str(2**64)], ["9223372036854775807"]),
    (["train", "quadrotor", "--list", "--ship"], ["--ship", "--list"]),
    (["train", "quadrotor", "gru", "--list", "--seed", "1"], ["--names", "--seed", "--list"]),
]


@pytest.mark.parametrize(("line", "names"), LINES, ids=lambda part: " ".join(part)[:40])
def test_a_mistake_about_the_command_itself(line, names, tmp_path):
    assert len(faultpath(*line).refused(*names)) < 800
    assert list(tmp_path.iterdir()) == []


def test_a_mistake_names_the_library_that_stands_for_the_one_not_named():
    ended = faultpath("trace", TOY, "--scene", "5")
    assert ended.status == 2
    assert "faultpath: library 'carts': unknown scene '5'; known: " in ended.err


def test_seeds_are_numbers_and_ranges():
    seeds = TypeAdapter[tuple[int, ...]](Seeds)
    assert seeds.validate_python("0..2,7") == (0, 1, 2, 7)
    for text, sentence in (
        ("0..9999", "at most 1000"),
        ("0,5..3", "ends below its beginning"),
        *((text, r"or 0\.\.2") for text in ("0-2", "1_0", "٣")),
        (str(2**63), "is not a seed"),
    ):
        with pytest.raises(ValueError, match=sentence):
            seeds.validate_python(text)


@pytest.mark.parametrize(
    ("limit", "workers", "name"), [("0", 1, "0 s"), ("nan", 1, "nan"), ("5", 0, "worker")]
)
def test_a_time_limit_that_limits_nothing_or_cannot_be_kept(limit, workers, name):
    audit(**{"time-limit": limit, "workers": workers}).refused("time", name)


@pytest.mark.parametrize(
    "error",
    [
        ImportError("libarrow.so.2600: failed to map segment from shared object"),
        ImportError("IMPORTANT\n\nOriginal error was: x.so: Cannot allocate memory\n"),
    ],
    ids=str,
)
def test_too_little_memory_is_no_failed_check(error, monkeypatch):
    def load(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("faultpath.api.audit.audits", load)
    ended = audit()
    assert (ended.status, ended.err.count("\n")) == (2, 1)
    assert "there is not enough memory" in ended.err


@pytest.mark.parametrize("arguments", [[], ["train"]])
def test_without_a_verb_there_is_help_and_no_traceback(arguments):
    ended = faultpath(*arguments)
    assert (ended.status, ended.err) == (2, "")
    assert "Usage" in ended.out


def test_options_given_several_times():
    audit("--set", "a=1", "--set", "a=2").refused("'a' twice")
    audit("--set", "a=1", "--set", "b=2").refused("'a'")  # the toy has neither


@pytest.mark.parametrize("text", ["a,", "a,,b", " ", "a, a"])
def test_lists_of_names_hold_each_name_once_and_no_empty_one(text):
    with pytest.raises(UserError, match=r"empty name|'a' twice"):
        ask(CheckQuestion, {"variants": text})
    assert ask(CheckQuestion, {"variants": "a, b"}).variants == ("a", "b")


def test_checks_that_nothing_could_be_seen_for_are_one_line(tmp_path):
    broken = written(tmp_path, "def run(self, *given):\n    raise ZeroDivisionError")
    shown = faultpath("check", broken, "--workers", "0").out.splitlines()
    (unjudged,) = [row for row in shown if row.startswith("not judged")]
    assert unjudged.startswith("not judged  determinism, scene independence, pairing, ")
