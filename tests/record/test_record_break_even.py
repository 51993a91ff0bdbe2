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


def test_the_set_is_at_the_level_of_the_decisions_at_both_ends():
    made = record({CORRECT: (40, 3, 14), "observer": (30, 30, 2), SHARED: (30, 30, 2)})
    alone = {each.path: each.result.level for each in made.break_even}
    assert all(level >= 0.95 for level in alone.values())
    (shared,) = [each for each in made.break_even if each.path == SHARED]
    assert shared.result.regions[-1].high == 1.0
    # The band leaves out 0 exactly where a region says so.
    for at, _, low, high in shared.curve:
        inside = any(r.low < at < r.high for r in shared.result.regions)
        if not any(abs(at - end) < 0.03 for r in shared.result.regions for end in (r.low, r.high)):
            assert inside == (low > 0 or high < 0) or not inside
