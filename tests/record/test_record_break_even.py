"""Break-even cells say only what is decided."""

import numpy as np
from outcome_tables import BASELINE, REPAIR, paths, question, record, rows

from faultpath.record import CORRECT, SHARED, decide, wording
from faultpath.trials import OutcomeTable, Status


def test_equal_arms_and_too_few_scenes_have_no_range():
    """A quarter of equal audits had one, at 95 % a frequency and without a correction."""
    stream, ranges = np.random.default_rng(3), 0
    for _ in range(25):
        out = [
            row
            for path in (CORRECT, "observer", SHARED)
            for variant in (BASELINE, REPAIR)
            for row in rows(
                variant,
                path,
                [Status.SUCCESS if s else Status.CRASH for s in stream.random(60) < 0.5],
            )
        ]
        asked = question(60).model_copy(update={"rule": "unconditional"})
        made = decide(asked, paths(CORRECT, "observer", SHARED), OutcomeTable(tuple(out)))
        for each in made.break_even:
            ranges += wording.break_even(each.result) != "any"
            assert bool(each.result.regions) <= any(effect.sign for effect in made.effects)
    assert ranges <= 2
    few = record({CORRECT: (0, 3, 0), SHARED: (0, 0, 3)}, 3)
    assert [wording.break_even(each.result) for each in few.break_even] == ["any"]
