"""A trace tells who read what, when; what differs from the declarations is a finding."""

import json
import re

import pytest
from checked import BROKEN, LOOPS
from cli_runs import ROOT, TOY, faultpath

from faultpath.core.errors import UserError
from faultpath.faults import FaultText
from faultpath.interface import Provenance
from faultpath.report.checks import trace_table
from faultpath.report.sentences.checks import describe_read
from faultpath.run.check.tracing import PermittedRead, trace_system
from faultpath.run.plan import SystemSpec
from faultpath.run.question import TraceQuestion
from faultpath.run.registry import load_system

DOCK = f"{ROOT / 'examples/dock.py'}:create"


def trace(name, variant, fault=None, library="selection", **options):
    spec = SystemSpec(name=name, options=options)
    system = load_system(spec)
    text = fault and FaultText.read(fault)
    question = TraceQuestion(variant=variant, library=library, fault=text)
    return system, trace_system(system, spec, question)


def test_it_says_who_read_what_and_when_and_stops_after_its_steps():
    system, traced = trace(TOY, "calibrated")
    assert {read.step for read in traced.reads} == {0, 1, 2}
    assert {read.reader for read in traced.reads} == system.variants["calibrated"].readers
    late = [read.valid_step for read in traced.reads if read.reader == "observer.executed"]
    assert late == [-1, 0, 1]
    assert traced.reconstructed == {"observed_slope": ("observer", ("gain", "push", "velocity"))}
    assert traced.findings == ()


def test_a_run_of_ones_own_is_traced_and_a_fault_shows_whom_it_reaches():
    _, traced = trace(DOCK, "ranges", "range:scale=0.7@speedometer", library="floors")
    altered = {read.reader: read.altered_by for read in traced.reads if read.altered_by}
    assert altered == {"speedometer.difference": ("scaled by 0.7",)}
    table = trace_table(traced)
    assert table.columns[3:5] == ("at steps", "of steps")
    assert table.notes[0].startswith("At steps: ")
    (speed,) = (line for line in table.lines if line.label == "approach.feedback")
    assert [entry.text for entry in speed.entries] == [
        *("speed", "", "range_rate", "0 1 2", "0 1 2", "speedometer")
    ]


def test_all_faults_of_an_injection_point_are_named():
    fault = "gain:scale=0.7@observer & gain:offset=0.1@observer"
    _, traced = trace(TOY, "calibrated", fault, library="carts")
    (altered,) = {read.altered_by for read in traced.reads if read.reader == "observer.model"}
    assert altered == ("scaled by 0.7", "offset by 0.1")


@pytest.mark.parametrize(
    ("name", "variant", "broken", "sentence"),
    [
        (BROKEN, "bare", "nosy", r"tap range -> guard.limit: this variant has no such reader"),
        (BROKEN, "guarded", "deaf", r"declares that guard.limit reads 'range', but in the first 3"),
        (BROKEN, "bare", "of the future", r"tap range -> pilot.approach: the reading is of step 1"),
        (
            LOOPS,
            "plain",
            "undeclared port",
            r"ended early: .*'position' at 'other', a port that it d",
        ),
    ],
)
def test_what_is_not_as_declared_is_found(name, variant, broken, sentence):
    if broken == "of the future":  # nothing was read before
        with pytest.raises(UserError, match=sentence):
            trace(name, variant, broken=broken)
        return
    _, traced = trace(name, variant, broken=broken)
    assert len(traced.findings) == 1
    assert re.search(sentence, describe_read(traced.findings[0]))


def test_a_privileged_read_without_permission_is_found():
    system, _ = trace(TOY, "calibrated")
    interface = system.interface
    known = interface.source("gain_estimate")
    secret = known.model_copy(update={"provenance": Provenance.PRIVILEGED})
    sources = tuple(secret if each.name == secret.name else each for each in interface.sources)
    system.interface = interface.model_copy(update={"sources": sources})
    vars(system).pop("_variants", None)
    question = TraceQuestion(variant="calibrated", library="carts")
    permitted = trace_system(system, SystemSpec(name=TOY), question)
    assert permitted.findings == ()
    readers = ("observer.model", "controller.inverse")
    assert permitted.privileged == tuple(PermittedRead(at, "gain_estimate") for at in readers)
    source = "'gain_estimate', which is privileged, by permission of the variant."
    assert describe_read(permitted.privileged[0]) == f"observer.model reads {source}"


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ({"variant": "blinded"}, "unknown variant 'blinded'; did you mean 'blind'?"),
        ({"variant": "blind", "scene": "cart/1"}, "library 'carts': unknown scene 'cart/1'"),
    ],
)
def test_what_cannot_be_traced_is_refused(more, sentence):
    system, _ = trace(TOY, "blind")
    with pytest.raises(UserError, match=re.escape(sentence)):
        trace_system(system, SystemSpec(name=TOY), TraceQuestion(**more))


def test_the_command_prints_and_exits_with_what_was_found():
    ended = faultpath("trace", TOY, "--variant", "blind", "--fault", "gain:scale=0.6")
    assert ended.status == 0
    assert "What ran is what is declared." in ended.out
    lines = ended.out.splitlines()
    assert max(len(each) for each in lines) <= 80
    assert "no gap" not in ended.out
    (reached,) = (line for line in lines if line.startswith("controller.inverse") and "by" in line)
    assert "gain scaled by 0.6 gain_estimate 0 1 2 0 1 2" in " ".join(reached.split())
    ended = faultpath("trace", BROKEN, "--broken", "nosy", "--json")
    assert (ended.status, len(json.loads(ended.out)["findings"])) == (1, 1)
    faultpath("trace", BROKEN, "--fault", "mass:scale=2@guard").refused("guard")
