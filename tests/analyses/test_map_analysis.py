"""What a map flies: two errors at two modules of one source, and mistakes in asking for it."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from faultpath.analyses.audit import audit_analysis
from faultpath.analyses.map.analysis import MapAnalysis, map_analysis
from faultpath.analyses.map.lattice import UNITS
from faultpath.core.errors import UserError
from faultpath.faults import FaultText
from faultpath.report.sentences.maps import size_label
from faultpath.run.plan import SystemSpec
from faultpath.run.question import AuditQuestion, MapQuestion, ask
from faultpath.run.registry import load_system
from faultpath.system import library_of

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SPEC = SystemSpec(name=f"{EXAMPLES / 'toy.py'}:create")
TOY = load_system(SPEC)
ASKED: dict[str, Any] = {
    "baseline": "calibrated",
    "repair": "blind",
    "fault": "gain",
    "against": ("controller", "observer"),
    "up_to": 0.4,
    "scenes": 8,
}


def analysis(**given: Any) -> MapAnalysis:
    return map_analysis(TOY, SPEC, ask(MapQuestion, ASKED | given), library_of(TOY, "carts"))


def test_the_conditions_of_an_audit_are_points_of_the_map() -> None:
    """To the treatment, so that both would be the same trials."""
    fault = FaultText.read("gain:scale=0.6")
    question = AuditQuestion(baseline="calibrated", repair="blind", fault=fault, scenes=8)
    audit = audit_analysis(TOY, SPEC, question, library_of(TOY, "carts"))
    points = [(0, 0), (-UNITS, 0), (0, -UNITS), (-UNITS, -UNITS)]
    names = dict(zip(("correct", "controller", "observer", "shared"), points, strict=True))
    made = analysis()
    treatments = {(row.variant, row.condition): row.treatment for row in made.plan(points).rows}
    for row in audit.plan.rows:
        assert treatments[row.variant, made.condition(names[row.condition])] == row.treatment


def test_errors_of_unequal_size_strike_each_its_own_module() -> None:
    rows = analysis().plan([(8, -16)]).rows
    faulted = {
        (row.variant, fault.readers, fault.intervention.factor)  # type: ignore[union-attr] - a scale
        for row in rows
        for fault in row.treatment.faults
    }
    assert faulted == {
        ("calibrated", ("controller.inverse",), 1.1),
        ("calibrated", ("observer.model",), 0.8),
        ("blind", ("controller.inverse",), 1.1),
    }


def test_an_offset_is_in_the_unit_of_the_reading() -> None:
    dock = SystemSpec(name=f"{EXAMPLES / 'dock.py'}:create")
    system = load_system(dock)
    question = {"baseline": "wheels", "repair": "ranges", "fault": "range:offset,onset=5"}
    question |= {"against": ("approach", "speedometer"), "up_to": 0.5, "scenes": 4}
    planned = map_analysis(system, dock, ask(MapQuestion, question), library_of(system, "floors"))
    assert not planned.facts.relative
    assert size_label(planned.facts, -0.25) == "−0.25 m"
    (fault,) = planned.plan([(0, 16)]).rows[1].treatment.faults
    assert (fault.onset_step, fault.intervention.by) == (5, 0.25)  # type: ignore[union-attr] - a bias


MISTAKES = yaml.safe_load(Path(__file__).with_name("mistakes.yaml").read_text("utf-8"))["map"]


@pytest.mark.parametrize(("given", "said"), MISTAKES)
def test_a_mistake_is_one_sentence(given: dict[str, Any], said: str) -> None:
    with pytest.raises(UserError) as refused:
        analysis(**given)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)
