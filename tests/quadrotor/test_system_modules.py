"""The parts of the quadrotor: their ports are the interface, and what flies reads them all."""

import pytest
import torch
from faultpath_quadrotor.estimators.protocol import ExactEstimator
from flights import HELD_OUT, STEPS, quadrotor

from faultpath.loop import Batch, readers
from faultpath.run.attempt import taps_of
from faultpath.run.check.reads import ReadLog
from faultpath.run.plan import Treatment

LEARNED = {"predictor": "wm-a-wind", "clearance": "depth", "wind": "L2"}
FLOWN = [
    *((LEARNED, variant) for variant in ("zero-wind", "gru", "wm-a", "wm-u", "dki-drag/gru+dcc")),
    ({}, "dob"),
    ({"predictor": "true-parameter"}, "true-wind"),
]
pytestmark = pytest.mark.usefixtures("short")


@pytest.mark.parametrize("clearance", ["true", "depth"])
def test_a_variants_readers_follow_from_its_ports_and_truth_has_one_door(clearance):
    system = quadrotor(clearance=clearance)
    for name, variant in system.variants.items():
        graph = system.loop(name, None).graph
        assert variant.readers == readers(graph.parts)
        assert [type(module) for module in graph.modules if module.truths] == [ExactEstimator]


@pytest.mark.parametrize(("options", "variant"), FLOWN, ids=[name for _, name in FLOWN])
def test_what_flies_reads_every_port_and_commands_late(options, variant):
    system = quadrotor(**options)
    batch = Batch(HELD_OUT[:2], 0, system.control_dt_s)
    log = ReadLog(batch.scenes)
    taps = taps_of(system, Treatment(variant=variant), batch.scenes, observer=log)
    with torch.inference_mode():
        instants = list(system.loop(variant, 0).execute(batch, taps))
    assert (len(instants), instants[-1].step) == (STEPS + 1, STEPS)
    reads = log.reads()
    assert {each.reader for each in reads} == set(system.variants[variant].readers)
    assert all(tap.deliveries == STEPS for tap in taps.delivery_log().taps)
    assert (system.variants[variant].privileged == set()) == (options is LEARNED)
    taught = {each.reader for each in reads if each.channel == "action"}
    late = {each.reader for each in reads if each.valid_step < each.step}
    assert late == taught - {"vehicle.actuators"}
