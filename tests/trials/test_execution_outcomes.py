"""What a system returns is checked where it ran: one bad outcome costs its trial, no more."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from toy_study import SCENES, study
from toy_system import ToySystem

from faultpath.loop import Reading
from faultpath.trials import Status, load_system
from faultpath.trials.attempt import WrongOutcomes
from faultpath.trials.execution.runner import run_study

HERE = Path(__file__)


class Sloppy(ToySystem):
    """Gives one field of its outcome in scene s05 another value."""

    def run(self, variant, scenes, taps, seed):
        outcomes = super().run(variant, scenes, taps, seed)
        changes = WRONG[self._options["wrong"]]
        if callable(changes):
            return changes(outcomes)
        return [replace(o, **changes) if o.scene == "s05" else o for o in outcomes]


WRONG = {
    "distance": {"metrics": {"distance": math.nan}},
    "status": {"status": "success"},
    "trace": {"trace": np.zeros((3, 2))},
    "object": {"trace": lambda: None},  # would not even cross to the parent
    "surrogate": {"initial_hash": "\ud800"},
    "error": {"status": Status.FAILED, "error": "lost \ud800"},
    "nothing": lambda outcomes: None,
    "dict": lambda outcomes: [vars(outcome) for outcome in outcomes],
    "order": lambda outcomes: outcomes[::-1],
}


def sloppy(**options: str) -> Sloppy:
    return Sloppy(**options)


def _study(wrong: str):
    asked = study(wrong=wrong)
    system = asked.system.model_copy(update={"name": f"{HERE}:sloppy"})
    return asked.model_copy(update={"system": system, "rows": asked.rows[:1]})


@pytest.mark.parametrize("workers", [0, 1])
@pytest.mark.parametrize("wrong", ["distance", "status", "trace", "object", "surrogate", "error"])
def test_a_malformed_outcome_fails_its_trial_alone(tmp_path, wrong, workers):
    result = run_study(_study(wrong), tmp_path, workers=workers)
    statuses = {row.outcome.scene: row.outcome.status for row in result.outcomes.rows}
    assert [scene for scene in SCENES if statuses[scene] is Status.FAILED] == ["s05"]
    (failure,) = result.failures
    assert failure.error
    assert failure.error in failure.details.read_text()
    assert run_study(_study(wrong), tmp_path, workers=0).outcomes_sha256 == result.outcomes_sha256


@pytest.mark.parametrize("workers", [0, 1])
@pytest.mark.parametrize(
    ("wrong", "said"),
    [("nothing", "a NoneType"), ("dict", "a dict in place of"), ("order", "in order")],
)
def test_no_outcomes_at_all_stop_the_study(tmp_path, wrong, said, workers):
    with pytest.raises(WrongOutcomes, match=said):
        run_study(_study(wrong), tmp_path, workers=workers)


def test_the_toy_survives_the_loss_of_its_gain(tmp_path):
    """Dividing by an erased gain gives no number; the trials fail, and the rest stands."""
    from faultpath.decisions.planning import plan_audit
    from faultpath.trials import SystemSpec
    from faultpath.trials.question import AuditQuestion

    spec = SystemSpec(name=f"{HERE.parents[2] / 'examples' / 'toy.py'}:create")
    system = load_system(spec)
    audit = plan_audit(
        system,
        spec,
        AuditQuestion(baseline="calibrated", repair="blind", fault="gain:erase", scenes=4),
        system.library("carts"),
    )
    with np.errstate(all="ignore"):
        result = run_study(audit.study, tmp_path, workers=0)
    failed = {(row.variant, row.path) for row in result.outcomes.failed()}
    assert failed == {(v, p) for v in ("calibrated", "blind") for p in ("controller", "shared")}
    assert "push -> cart.motor: the first reading is not finite" in result.failures[0].error


class Holey(ToySystem):
    """Its mass is not a number in scene s05."""

    def run(self, variant, scenes, taps, seed):
        taps.deliver("mass", "planner.thrust", self._mass(scenes), 0)
        return super().run(variant, scenes, taps, seed)

    def _mass(self, scenes):
        value = np.array([math.nan if scene == "s05" else 1.0 for scene in scenes])
        return Reading(value, "mass", 0)


class Scribbler(ToySystem):
    """Writes into what its tap gave it."""

    def run(self, variant, scenes, taps, seed):
        mass = Reading(np.ones(len(scenes)), "mass", 0)
        got = taps.deliver("mass", "planner.thrust", mass, 0)
        got *= 2.0
        return super().run(variant, scenes, taps, seed)


def holey(**options: str) -> Holey:
    return Holey(**options)


def scribbler(**options: str) -> Scribbler:
    return Scribbler(**options)


def _one_row(factory: str):
    asked = study(SCENES[4:8])
    system = asked.system.model_copy(update={"name": f"{HERE}:{factory}"})
    return asked.model_copy(update={"system": system, "rows": asked.rows[:1]})


def test_a_reading_that_is_no_number_costs_its_scene_alone(tmp_path):
    result = run_study(_one_row("holey"), tmp_path, workers=0)
    (failure,) = result.failures
    assert failure.scene == "s05"
    assert "tap mass -> planner.thrust: the first reading is not finite" in failure.error


def test_a_consumer_that_writes_is_told_to_copy(tmp_path):
    result = run_study(_one_row("scribbler"), tmp_path, workers=0)
    assert len(result.failures) == 4
    assert "what a tap delivers cannot be written to" in result.failures[0].error
