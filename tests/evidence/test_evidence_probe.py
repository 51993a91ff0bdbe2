"""A probe: which measurements it asks for, and what it makes of them."""

import math

import numpy as np
import pytest

from faultpath.errors import UserError
from faultpath.evidence import EvidenceTable, Measured, Recording
from faultpath.evidence.probe import ProbePlan, expected_perturbations
from faultpath.interface import Channel, Interface, Provenance, Source
from faultpath.interface.model import Uncertainty
from faultpath.streams import generator

RECORDING = Recording(library="selection", variant="true-parameter")
PLAN = ProbePlan(RECORDING, ("a", "b"), ("mass:scale=1.1", "mass:scale=0.9"), (0, 1))


def table(scale: dict[str, float]) -> EvidenceTable:
    """Return responses in which each variant moves `scale` times as far, m."""
    base = generator("test-probe", "responses", 0).random(40) + 0.1
    scenes = tuple(f"s{i // 4}" for i in range(40))
    return EvidenceTable(
        {
            asked: Measured(scenes, np.arange(40), scale[asked.subject] * base)
            for asked in PLAN.measurements()
        }
    )


def test_a_probe_asks_for_the_response_of_every_variant_seed_and_perturbation():
    asked = PLAN.measurements()
    assert len(set(asked)) == 8
    assert {each.quantity for each in asked} == {"position-response"}
    assert {each.recording for each in asked} == {RECORDING}


def test_responses_are_medians_in_centimetres_and_ratios_are_to_the_first_variant():
    responses = table({"a": 0.5, "b": 0.125})
    probe = PLAN.conclude(responses)
    assert [(row.perturbation, row.variant) for row in probe.rows] == [
        (perturbation, variant) for perturbation in PLAN.perturbations for variant in "ab"
    ]
    first, other = probe.rows[:2]
    median = np.median(responses.values(PLAN.measurements()[0]).values)
    assert first.response_cm.value == pytest.approx(100 * median)
    assert first.response_cm.n_seeds == 2
    assert first.log_ratio is None
    assert other.log_ratio is not None
    assert math.exp(other.log_ratio.value) == pytest.approx(0.25)
    assert other.log_ratio.high < 0
    assert (probe.windows, probe.scenes) == (40, 10)


def test_what_does_not_move_has_no_ratio():
    probe = PLAN.conclude(table({"a": 0.5, "b": 0.0}))
    assert probe.rows[1].response_cm.value == 0.0
    assert probe.rows[1].log_ratio is None


@pytest.mark.parametrize(
    "wrong", [{"variants": ()}, {"variants": ("a", "a")}, {"perturbations": ()}, {"seeds": (0, 0)}]
)
def test_nothing_twice_and_nothing_missing(wrong):
    given = {"variants": ("a",), "perturbations": ("mass:scale=2",), "seeds": (0,)}
    with pytest.raises(UserError, match=next(iter(wrong))):
        ProbePlan(RECORDING, **(given | wrong))


def interface(*uncertainties: Uncertainty | None) -> Interface:
    names = [f"s{i}" for i in range(len(uncertainties))]
    return Interface(
        name="toy",
        sources=tuple(
            Source(
                name=name,
                unit="kg",
                provenance=Provenance.ESTIMATED,
                uncertainty=uncertainty,
                correlation_group="calibration",
            )
            for name, uncertainty in zip(names, uncertainties, strict=True)
        ),
        channels=tuple(
            Channel(name=f"c{name}", sources=(name,), consumers=("predictor.x",)) for name in names
        ),
    )


def test_without_a_wish_a_group_is_perturbed_by_the_half_range_that_it_declares():
    declared = Uncertainty(half_range=0.1, relative=True)
    toy = interface(declared, declared)
    assert expected_perturbations(toy, ["calibration"]) == ["calibration=+0.1"]
    for other in (
        interface(declared, None),
        interface(declared, Uncertainty(half_range=0.2, relative=True)),
        interface(Uncertainty(half_range=0.1)),
    ):
        with pytest.raises(UserError, match="--perturb"):
            expected_perturbations(other, ["calibration"])
    with pytest.raises(UserError, match="--perturb"):
        expected_perturbations(toy, [])
