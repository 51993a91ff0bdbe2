"""The page about sensors' faults says what is significant, and nothing of what is not."""

import blocks
import numpy as np
import pytest
import state_study
from documents import BLOCKS
from state_design import Audit, Design
from studies import sensor_sentences, sensors

from faultpath.analyses.family import decide_conditions


def audit(scenes: int, alone: int, shared: int) -> Audit:
    """Decide an audit in which the versions differ in all scenes, to a side or (0) in none."""

    def variants(side: int):
        won, lost = (np.full((scenes, 1), side == of) for of in (1, -1))
        return won, lost

    success = {"correct": variants(0), "observer": variants(alone), "shared": variants(shared)}
    family = decide_conditions(success)
    effects = {
        n: [e.value, *(e.interval or (-100, 100)), e.sign] for n, e in family.effects.items()
    }
    turns = dict(family.turns)
    return Audit(fault="bias", repair="filter", success={}, effects=effects, turns=turns)


@pytest.mark.parametrize("scenes", [1, 2, 4])
def test_few_scenes_are_inconclusive(scenes):
    first, last = sensor_sentences([audit(scenes, 1, -1), audit(scenes, 0, 0)])
    assert "more often than the baseline in none and less often in none." in first
    assert last.startswith("No reversal was found, which does not show that there is none")
    assert "2 (filter under bias and filter under bias)" in last


DETECTS = "shows {} (significantly different from the shared effect: {})"


@pytest.mark.parametrize(
    ("effects", "helps", "harms", "detects", "reversal"),
    [
        ((1, -1), "none", "1 (filter under bias)", ("none", "1"), "A reversal was found in 1;"),
        ((0, 1), "1 (filter under bias)", "none", ("none", "1"), "No reversal was found"),
        ((1, 1), "1 (filter under bias)", "none", ("1", "none"), "No reversal was found"),
    ],
)
def test_many_scenes_say_which_side_and_what_an_isolated_test_detects(
    effects, helps, harms, detects, reversal
):
    first, alone, last = sensor_sentences([audit(40, *effects)])
    assert f"in {helps} and less often in {harms}." in first
    assert DETECTS.format(*detects) in alone
    assert last.startswith(reversal)


def test_every_audit_is_shown_once_and_a_repair_has_no_name_of_a_sensor():
    rows, audits = BLOCKS["state:effects"]().splitlines()[2:], sensors().audits
    assert len(rows) == len(audits)
    assert not {audit.repair for audit in audits} & {"accelerometer", "gyroscope"}


def test_the_design_names_what_it_flies():
    design = Design.read(blocks.ROOT / "experiments" / "state-errors" / "design.yaml")
    assert {fault for fault, _ in design.audits} <= {*design.faults}
    assert {repair for _, repair in design.audits} <= {*design.repairs}
    assert design.variants["gyroscope bias"] == {
        "gru": "eskf-no-bias",
        "wm-a-nowind": "eskf-no-bias",
        "dob-inertial": "eskf-no-bias",
        "eskf/gru": "eskf",
    }


def test_a_study_without_workers_is_refused_in_a_sentence(capsys):
    with pytest.raises(SystemExit, match="2"):
        state_study.main(["--workers", "0"])
    assert "--workers 0: give at least one" in capsys.readouterr().err
