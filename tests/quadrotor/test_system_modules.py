"""The parts of the quadrotor: their ports are the interface, and what flies reads them all."""

import numpy as np
import pytest
import torch
from faultpath_quadrotor.estimators.protocol import ExactEstimator
from faultpath_quadrotor.system import Quadrotor
from flights import HELD_OUT, STEPS, fault, fly, quadrotor

from faultpath.loop import Batch, Graph, consumers
from faultpath.systems.checks.recording import Recording
from faultpath.trials import Arm
from faultpath.trials.attempt import taps_of

LEARNED = {"predictor": "wm-a-wind", "clearance": "depth", "wind": "L2"}
FLOWN = [
    *((LEARNED, each) for each in ("zero-wind", "gru", "dob", "wm-a", "wm-u", "dki-drag/gru+dcc")),
    *(({}, variant) for variant in ("zero-wind", "dob")),
    ({"predictor": "true-parameter"}, "true-wind"),
]
pytestmark = pytest.mark.usefixtures("short")


@pytest.fixture(scope="module")
def systems() -> tuple[Quadrotor, ...]:
    return quadrotor(clearance="true"), quadrotor(clearance="depth")


def graphs(systems: tuple[Quadrotor, ...]) -> list[Graph]:
    """Return what every variant executes, with either clearance."""
    return [system.loop(name, None).graph for system in systems for name in system.variants]


def test_a_variants_consumers_follow_from_its_ports(systems):
    for system in systems:
        for name, variant in system.variants.items():
            assert variant.consumers == consumers(system.loop(name, None).graph.parts)


def test_truth_has_one_door(systems):
    for graph in graphs(systems):
        assert [type(each) for each in graph.modules if each.truths] == [ExactEstimator]


@pytest.mark.parametrize(("options", "variant"), FLOWN, ids=[name for _, name in FLOWN])
def test_what_flies_reads_every_port_and_commands_late(options, variant):
    system = quadrotor(**options)
    batch = Batch(HELD_OUT[:2], 0, system.control_dt_s)
    recording = Recording(batch.scenes)
    taps = taps_of(system, Arm(variant=variant), batch.scenes, observer=recording)
    with torch.inference_mode():
        instants = list(system.loop(variant, 0).execute(batch, taps))
    assert (len(instants), instants[-1].step) == (STEPS + 1, STEPS)
    reads = recording.reads.values()
    assert {each.consumer for each in reads} == set(system.variants[variant].consumers)
    assert all(tap.deliveries == STEPS for tap in taps.receipts().taps)
    assert (system.variants[variant].privileged == set()) == (options is LEARNED)
    taught = {each.consumer for each in reads if each.channel == "action"}
    late = {each.consumer for each in reads if each.valid_step < each.step}
    assert late == taught - {"vehicle.actuators"}


@pytest.mark.parametrize(
    ("text", "tap"),
    [
        ("rollout:offset=0.5", ("rollout", "planner.candidates")),
        ("rollout:noise=0.2", ("rollout", "planner.candidates")),
        ("hover:scale=1.2", ("hover", "planner.reference")),
    ],
)
def test_a_fault_between_predictor_and_planner_changes_the_command(text, tap):
    system = quadrotor()
    _, plain = fly(system)
    _, faulted = fly(system, faults=[fault(text, system)])
    commands = [taps.delivered("action", "vehicle.actuators")[0] for taps in (plain, faulted)]
    assert not np.array_equal(*commands)
    receipt = faulted.receipts().at(*tap)
    assert receipt.steps_altered.tolist() == [STEPS]
    assert receipt.asks == (STEPS if tap[0] == "rollout" else 0)
    altered = [each for each in faulted.receipts().taps if each.steps_altered.any()]
    assert [(each.channel, each.consumer) for each in altered] == [tap]
