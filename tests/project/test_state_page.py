"""The page about sensors' faults says what was decided, and nothing of what was not."""

import numpy as np
import pytest
import state_blocks as blocks

from faultpath.decisions.family import decide_paths


def audit(scenes: int, alone: int, shared: int) -> dict:
    """Decide an audit in which the arms differ in all scenes, to a side or (0) in none."""

    def arms(side: int):
        won, lost = (np.full((scenes, 1), side == of) for of in (1, -1))
        return won, lost

    success = {"correct": arms(0), "present": arms(alone), "shared": arms(shared)}
    family = decide_paths(success, rule="unconditional")
    effects = {
        n: [e.value, *(e.interval or (-100, 100)), e.sign] for n, e in family.effects.items()
    }
    return {"fault": "bias", "repair": "filter", "effects": effects, "turns": dict(family.turns)}


@pytest.mark.parametrize("scenes", [1, 2, 4])
def test_few_scenes_decide_nothing(scenes):
    told = blocks.said([audit(scenes, 1, -1), audit(scenes, 0, 0)])
    open_ = (
        "filter, bias: not decided with the fault shared; not decided at the predictor's present."
    )
    assert told == ["No reversal was decided in 2 audits.", open_, open_]


def test_no_audit_is_no_sentence_about_repairs():
    assert blocks.said([]) == ["No reversal was decided in 0 audits."]


def test_many_scenes_say_which_side_and_where_it_did_not_show():
    lead, told = blocks.said([audit(40, 1, -1)])
    assert lead == "A reversal was decided in 1 of 1 audit."
    assert "behind with the fault shared; ahead at the predictor's present." in told
    assert told.endswith("the reverse of that at the predictor's present.")
    lead, told = blocks.said([audit(40, 0, 1)])
    assert lead == "No reversal was decided in 1 audit."
    assert "ahead with the fault shared; not decided at the predictor's present." in told
    assert told.endswith("to differ from that at the predictor's present.")
    _, ties = blocks.said([audit(40, 0, 0)])
    assert "ahead" not in ties
    assert "behind" not in ties
