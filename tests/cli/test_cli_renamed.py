"""What version 0.1 took is refused with what stands for it now."""

import pytest
from cli_runs import TOY, faultpath

import faultpath as engine
from faultpath.core.error_source import described
from faultpath.faults import Fault, Scale
from faultpath.loop.module import Progress
from faultpath.systems.gymnasium import GymnasiumPlant
from faultpath.trials import Outcome

COMMANDS = {
    ("claims",): "faultpath reproduce --judge",
    ("compare", "a", "b"): "faultpath report",
    ("interface", "quadrotor"): "faultpath trace",
    ("runs",): "faultpath report",
    ("audit", TOY, "--memory-limit", "2"): "ulimit",
    ("check", TOY, "--time-limit", "9"): "time_limit_s",
    ("plan", TOY, "--factorial"): "joined by `&`",
    ("replay", "run", "--out", "x.mp4"): "--export FILE.mcap",
}
CALLS = {
    "audit": (lambda: engine.audit(TOY, memory_limit_gib=2), "ulimit"),
    "map": (lambda: engine.reversal_map(TOY, share="runs"), "leave it out"),
    "plan": (lambda: engine.plan(TOY, faults="gain:scale=2"), "say fault"),
    "function": (lambda: engine.reproduce, "faultpath_quadrotor.reproduce"),
    "Outcome": (lambda: Outcome(struck_steps=1), "say faulted_steps"),
    "Outcome of a vehicle": (lambda: Outcome(min_clearance_m=1.0), "{'min_clearance_m': ...}"),
    "Progress": (lambda: Progress(terminal_distance_m=[1.0]), "{'terminal_distance_m': ...}"),
    "GymnasiumPlant": (lambda: GymnasiumPlant("CartPole-v1", vector=True), "leave it out"),
    "Fault": (lambda: Fault(intermittence=None), "give onset_step"),
    "method": (lambda: Fault(channel="a", intervention=Scale(factor=2)).striking, "say aimed_at"),
}


@pytest.mark.parametrize(("arguments", "says"), COMMANDS.items(), ids=" ".join)
def test_a_command_of_version_0_1(arguments, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    sentence = faultpath(*arguments).refused()
    assert "since version 0.2" in sentence
    assert says in sentence


@pytest.mark.parametrize(("call", "says"), CALLS.values(), ids=CALLS)
def test_a_call_of_version_0_1(call, says):
    with pytest.raises((TypeError, AttributeError, engine.UserError)) as caught:
        call()
    assert "since version 0.2" in str(caught.value)
    assert says in str(caught.value)


def test_a_module_of_version_0_1_in_a_system(tmp_path):
    system = tmp_path / "mine.py"
    system.write_text("from faultpath.taps import Reading\n")
    assert "since version 0.2 it is faultpath.loop" in faultpath("check", system).refused()


def test_what_never_was_is_refused_as_before():
    with pytest.raises(TypeError, match="unexpected keyword argument 'wheels'") as caught:
        Outcome(wheels=4)
    assert "0.2" not in described(caught.value)
    with pytest.raises(AttributeError, match="no attribute 'wheels'"):
        _ = Fault(channel="a", intervention=Scale(factor=2)).wheels
