"""Where two trials of a scene part: the first step of each kind, and the sentence on it."""

from dataclasses import replace

import numpy as np
import pytest

from faultpath.analyses.facts import ComparisonFacts
from faultpath.analyses.parting import Parting, Recorded, parting
from faultpath.interface import read_interface
from faultpath.report.sentences.parting import compared, ending, parted
from faultpath.run.shown import SystemShown, VariantShown
from faultpath.run.store.signals import Signal
from faultpath.run.store.tables import TrialAddress
from faultpath.system import Outcome, Status

DT_S = 0.05
INTERFACE = """
name: craft
sources:
- {name: speedometer, unit: m/s, provenance: measured}
- {name: mass_estimate, unit: kg, provenance: estimated}
- {name: observed_wind, unit: 'm/s, deg', shape: [2], provenance: reconstructed}
- {name: zero_wind, unit: 'm/s, deg', shape: [2], provenance: constant}
- {name: push, unit: N, provenance: commanded}
channels:
- {name: speed, sources: [speedometer], readers: [observer.difference]}
- {name: mass, sources: [mass_estimate], gap: fidelity, readers: [observer.model, pilot.inverse]}
- {name: wind, sources: [observed_wind, zero_wind], readers: [pilot.feedforward]}
- {name: push, sources: [push], readers: [observer.executed, craft.motor]}
reconstructs: {observer: observed_wind}
"""
PILOT = ("pilot.inverse", "pilot.feedforward", "craft.motor")
OBSERVER = ("observer.difference", "observer.model", "observer.executed")
FACTS = ComparisonFacts(
    system="craft",
    library="held-out",
    library_hash="0" * 16,
    n_scenes=1,
    seeds=(0,),
    ends={"crash": "hit the door"},
)
STEPS = 6
UNITS = {"speedometer": "m/s", "observed_wind": "m/s, deg", "push": "N"}
EQUAL = {
    "speedometer": np.arange(STEPS),
    "mass_estimate": np.full(STEPS, 2.0),
    "observed_wind": np.tile([1.0, 90.0], (STEPS, 1)),
    "push": np.full(STEPS, 3.0),
}


def shown(**bindings: str) -> SystemShown:
    variants = (
        VariantShown(name="old", readers=PILOT + OBSERVER, bindings={}),
        VariantShown(name="new", readers=PILOT + OBSERVER, bindings=bindings),
        VariantShown(name="bare", readers=PILOT, bindings={"wind": "zero_wind"}),
    )
    return SystemShown(
        control_dt_s=DT_S, interface=read_interface(INTERFACE), variants=variants, plans={}
    )


def heard(
    variant: str, condition: str = "shared", end: Status | None = Status.SUCCESS, time_s=0.3, **new
) -> Recorded:
    """Return a trial whose signals are those of `EQUAL`, but for the `new` ones: from a step on
    they have a value."""
    series = {name: values.astype(np.float64).reshape(STEPS, -1) for name, values in EQUAL.items()}
    for name, (step, value) in new.items():
        series[name] = series[name].copy()
        series[name][step:] = value
    signals = tuple(
        Signal(name, name, UNITS.get(name, "1"), values.astype(np.float32))
        for name, values in series.items()
    )
    address, outcome = TrialAddress(variant, condition, 0, "door-3"), None
    if end is not None:
        error = "no number" if end is Status.FAILED else None
        outcome = Outcome("door-3", end, time_s, "i", "d", "n", error=error)
    return Recorded(address, outcome, signals)


def faulted(trial: Recorded, reader: str, got: float) -> Recorded:
    """Return the trial with a fault that lets a reader of the mass get a number from step 1 on."""
    values = np.array([2.0, *[got] * (STEPS - 1)], np.float32)[:, None]
    more = (
        Signal(f"mass at {reader}", "mass", "kg", values),
        Signal(f"mass error at {reader}", "mass error", "kg", values - 2.0),
    )
    return replace(trial, signals=(*trial.signals, *more))


def without(trial: Recorded, *names: str) -> Recorded:
    return replace(trial, signals=tuple(s for s in trial.signals if s.name not in names))


OLD = heard("old")
WIND = {"observed_wind": (2, (1.0, 80.0))}
CASES = {
    "reading, command, state, and how each ended": (
        heard("old", end=Status.CRASH, time_s=0.28),
        heard("new", **WIND, push=(2, 4), speedometer=(4, 9)),
        "At 0.10 s the wind (component 2) that the pilot reads is 90 deg in old, 80 deg in new; "
        "the commands differ at the same time; 0.10 s later the state differs; old ended at "
        "0.28 s (hit the door), new at 0.30 s (success).",
    ),
    "never": (
        OLD,
        heard("new"),
        "No recorded reading, command or state differs; both ended at 0.30 s (success).",
    ),
    "only readings": (
        OLD,
        heard("new", **WIND),
        "At 0.10 s the wind (component 2) that the pilot reads is 90 deg in old, 80 deg in new; "
        "no recorded command or state differs; both ended at 0.30 s (success).",
    ),
    "a command before any reading": (
        OLD,
        without(heard("new", push=(1, 3.0001)), "observed_wind", "mass_estimate"),
        "At 0.05 s the commands differ: push is 3 N in old, 3.0001 N in new; no recorded reading "
        "or state differs; both ended at 0.30 s (success).",
    ),
    "what the plant measures, and what reads it": (
        without(OLD, "push"),
        heard("new", speedometer=(3, -8)),
        "At 0.15 s the speed that the observer reads is 3 m/s in old, −8 m/s in new; they differ "
        "most at 0.25 s: 5 m/s in old, −8 m/s in new; the state differs at the same "
        "time; both ended at 0.30 s (success).",
    ),
    "a module of one version": (
        OLD,
        heard("bare", push=(0, 1), speedometer=(1, 5)),
        "At 0.00 s the commands differ: push is 3 N in old, 1 N in bare; 0.05 s later the state "
        "differs; no recorded reading differs; both ended at 0.30 s (success). Only old has the "
        "module observer.",
    ),
    "what readers got of a fault": (
        faulted(OLD, "pilot.inverse", 1.0),
        faulted(heard("new"), "pilot.inverse", 1.5),
        "At 0.05 s the mass that the pilot got is 1 kg in old, 1.5 kg in new; no recorded command "
        "or state differs; both ended at 0.30 s (success).",
    ),
    "one version under two conditions": (
        heard("new", "correct", Status.CRASH, 0.2),
        faulted(faulted(heard("new", push=(3, 6)), "observer.model", 1.0), "pilot.inverse", 1.0),
        "At 0.05 s the mass that the observer got is 2 kg under correct inputs, 1 kg under the "
        "shared fault (and 1 more reading differs); 0.10 s later the commands differ; no recorded "
        "state differs; it ended at 0.20 s (hit the door) under correct inputs, at "
        "0.30 s (success) under the shared fault.",
    ),
    "nothing in common": (
        replace(OLD, signals=()),
        heard("new"),
        "Nothing was recorded of both trials that could be compared; both ended at 0.30 s "
        "(success).",
    ),
    "a trial that failed": (
        OLD,
        heard("new", end=Status.FAILED),
        "Nothing to compare: new under the shared fault failed (no number).",
    ),
    "trials that never ran": (
        heard("old", end=None),
        heard("new", end=None),
        "Nothing to compare: old under the shared fault did not run and new under the shared fault "
        "did not run.",
    ),
    "a time that nobody says": (
        heard("old", time_s=np.nan),
        heard("new", time_s=np.nan, end=Status.TIMEOUT),
        "No recorded reading, command or state differs; old ended (success), new (timeout).",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_a_sentence_says_where_two_trials_part(case: str) -> None:
    one, other, sentence = CASES[case]
    parting_of = parting(shown(), one, other)
    assert parted(FACTS, parting_of) == sentence
    assert Parting.model_validate_json(parting_of.model_dump_json()) == parting_of


def test_further_states_that_differ_are_counted() -> None:
    """They were "2 more quantitys"."""
    told = parting(shown(), without(OLD, "push"), heard("new", speedometer=(3, -8)))
    state = told.first["state"].model_copy(update={"others": 2})
    said = parted(FACTS, told.model_copy(update={"first": {"state": state}}))
    assert "(and 2 more states differ)" in said
    assert "no recorded reading differs" in said


def test_a_channel_is_compared_whatever_feeds_it() -> None:
    """What a fault does to one trial alone is compared only until the sources differ themselves."""
    told = parting(shown(wind="zero_wind"), OLD, without(heard("new"), "observed_wind"))
    assert "reading" not in told.first
    both = faulted(heard("new", mass_estimate=(0, 5.0)), "pilot.inverse", 1.0)
    assert parting(shown(), OLD, both).first["reading"].values == (2.0, 5.0)


def test_components_have_their_own_names_and_units() -> None:
    trials = [heard("old"), heard("new", **WIND)]
    named = [
        replace(
            trial,
            signals=tuple(
                replace(s, parts=("speed", "course")) if s.name == "observed_wind" else s
                for s in trial.signals
            ),
        )
        for trial in trials
    ]
    first = parting(shown(), named[0], named[1]).first["reading"]
    assert (first.part, first.unit, first.component) == ("course", "deg", 2)


def test_the_end_of_one_trial_is_a_mark_where_the_other_goes_on() -> None:
    told = parting(shown(), heard("old", time_s=0.12), heard("new"))
    assert ending(told, DT_S) == [(3, "old has ended")]
    assert ending(parting(shown(), OLD, heard("new")), DT_S) == []
    assert compared(told) == "door-3, seed 0, shared, old and new"
    same = parting(shown(), heard("new", "correct"), heard("new"))
    assert compared(same) == "door-3, seed 0, new, correct and shared"


def test_positions_are_the_state_of_trials_without_signals() -> None:
    def moved(variant: str, to: float) -> Recorded:
        trace = np.array([[0, 0, 0], [0, to, 0]], np.float32)
        trial = replace(heard(variant), signals=())
        assert trial.outcome is not None
        return replace(trial, outcome=replace(trial.outcome, trace=trace))

    told = parting(shown(), moved("old", 1.0), moved("new", 1.5))
    assert told.compared == ("state",)
    assert parted(FACTS, told).startswith(
        "At 0.05 s the state differs: position (component 2) is 1 m in old, 1.5 m in new;"
    )
