"""What a fault does is said with its own number, sign and unit, for every kind that there is."""

import pytest
from outcome_tables import question

from faultpath.decisions.fault_words import fault_words
from faultpath.faults import INTERVENTIONS, Coupled, Fault, Noise, Scale, Sequence, parse_fault
from faultpath.interface import read_interface

INTERFACE = read_interface("""
name: made_up
sources:
- {name: scales, unit: kg, provenance: estimated, correlation_group: calibration}
- {name: gain_estimate, unit: '1', provenance: estimated, correlation_group: calibration}
- {name: pitot, unit: m/s, shape: [3], provenance: measured}
- {name: camera, unit: m, shape: [36, 64], provenance: measured}
- {name: command, unit: 'N, rad/s', shape: [4], provenance: commanded}
channels:
- {name: mass, sources: [scales], consumers: [model.trim], erasure_default: 1.5}
- {name: thrust_scale, sources: [gain_estimate], consumers: [model.trim]}
- {name: wind, sources: [pitot], consumers: [model.map]}
- {name: depth, sources: [camera], consumers: [model.eye]}
- {name: action, sources: [command], consumers: [model.history]}
""")
SAID = {
    "mass:scale=1.1": "Mass is supplied 10 % too high (times 1.1).",
    "thrust_scale:scale=0.9": "Thrust scale is supplied 10 % too low (times 0.9).",
    "mass:scale=1": "Mass is supplied as it is (times 1).",
    "mass:scale=-0.5": "Mass is supplied times −0.5.",
    "mass:scale=3": "Mass is supplied times 3.",
    "wind:scale=1.25": "Wind is supplied 25 % too large (times 1.25).",
    "wind:scale=1/0.5/1": "Wind is supplied times (1, 0.5, 1).",
    "mass:uniform_scale=0.2": (
        "Mass is supplied times a factor drawn once a scene between 0.8 and 1.2."
    ),
    "mass:offset=-0.3": "Mass is supplied 0.3 kg too low.",
    "mass:offset=0": "Mass is supplied as it is (shifted by 0 kg).",
    "wind:offset=2": "Wind is supplied, each of its numbers, 2 m/s too high.",
    "wind:offset=1/0/-1": "Wind is shifted by (1, 0, −1) m/s.",
    "action:offset=1": "Action is supplied, each of its numbers, 1 (N, rad/s) too high.",
    "mass:quantise=0.25": "Mass is rounded to multiples of 0.25 kg.",
    "mass:erase": "Mass is replaced by 1.5 kg, which carries no information.",
    "wind:noise=0.1": (
        "Wind is supplied with noise drawn at each step, standard deviation 0.1 m/s."
    ),
    "wind:noise=0.1,relative": (
        "Wind is supplied with noise drawn at each step, standard deviation 10 % of the reading."
    ),
    "mass:drift=-0.1": "Mass is supplied with an error that grows by −0.1 kg a second.",
    "mass:drift=0,walk_per_sqrt_s=0.2": (
        "Mass is supplied with a random walk of standard deviation 0.2 kg after a second."
    ),
    "mass:bias=0.2": (
        "Mass is supplied with an error drawn once a scene, standard deviation 0.2 kg."
    ),
    "mass:bias=0.2,time_constant_s=4": (
        "Mass is supplied with a wandering error, standard deviation 0.2 kg, time constant 4 s."
    ),
    "wind:delay=5": "Wind is delivered 5 steps (0.25 s) late.",
    "wind:delay=1": "Wind is delivered 1 step (0.05 s) late.",
    "wind:hold=4": "Wind is refreshed only every 4 steps (0.2 s).",
    "wind:freeze": "Wind is frozen at what it shows when the fault begins.",
    "wind:dropout=0.3": (
        "Wind is lost at each step with probability 30 %, and the last that arrived stands in."
    ),
    "mass:dropout=0.3,substitute=erase": (
        "Mass is lost at each step with probability 30 %, and then replaced by 1.5 kg, which "
        "carries no information."
    ),
    "mass:replace=2": "Mass is replaced by 2 kg.",
    "wind:shuffle=1": "Wind is shuffled along axis 1.",
    "wind:freeze,onset=20,for_s=2,recover=5": (
        "Wind is frozen at what it shows when the fault begins. In force from step 20 (1 s), for "
        "40 steps (2 s), then back to the reading over 5 steps (0.25 s)."
    ),
    "mass:scale=1.1,on_s=1,off_s=4": (
        "Mass is supplied 10 % too high (times 1.1). In force on for 1 s and off for 4 s on "
        "average."
    ),
    "calibration:bias=0.1,relative,correlation=0.5": (
        "Mass is supplied with an error drawn once a scene, standard deviation 10 % of the "
        "reading; thrust scale is supplied with an error drawn once a scene, standard deviation "
        "10 % of the reading. The errors have a correlation of 0.5."
    ),
}


@pytest.mark.parametrize("text", SAID)
def test_a_fault_is_told_in_numbers_and_units(text: str) -> None:
    fault = parse_fault(text, INTERFACE, {}, 0.05)
    recorded = question().model_copy(update={"faults": fault.resolved(INTERFACE)})
    assert fault_words(recorded, INTERFACE, 0.05) == SAID[text]


def test_every_kind_of_fault_is_told() -> None:
    told = {text.partition(":")[2].partition("=")[0].partition(",")[0] for text in SAID}
    assert set(INTERVENTIONS) - told == {"sequence"}


def test_several_channels_and_a_sequence_are_told_one_by_one() -> None:
    preset = Coupled(
        name="calibration",
        faults=(
            Fault(channel="mass", intervention=Scale(factor=1.1)),
            Fault(channel="thrust_scale", intervention=Scale(factor=0.9)),
        ),
    )
    asked = question().model_copy(update={"faults": preset.resolved(INTERFACE)})
    assert fault_words(asked, INTERFACE, 0.05) == (
        "Mass is supplied 10 % too high (times 1.1); thrust scale is supplied 10 % too low "
        "(times 0.9). These errors have one cause."
    )
    turns = Sequence(parts=(Noise(std=0.02), Scale(factor=1.5)))
    later = Fault(channel="mass", intervention=turns, onset_step=3)
    faults = [each.resolved(INTERFACE)[0] for each in (later, preset.faults[1])]
    asked = question().model_copy(update={"faults": tuple(faults)})
    assert fault_words(asked, INTERFACE, 0.1) == (
        "Mass is supplied with noise drawn at each step, standard deviation 0.02 kg, then "
        "supplied 50 % too high (times 1.5), in force from step 3 (0.3 s); thrust scale is "
        "supplied 10 % too low (times 0.9)."
    )
