"""A factorial: effects as the textbook defines them, decided in one family."""

from itertools import product

import numpy as np
import pytest
from outcome_tables import BASELINE, REPAIR, question, rows

from faultpath.record.factorial import factorial, path_of, subsets
from faultpath.trials import OutcomeTable, Status

FACTORS = ("controller", "observer", "planner")


def table(success: dict[tuple[str, tuple[str, ...]], np.ndarray]) -> OutcomeTable:
    made = []
    for (variant, struck), won in success.items():
        ends = [Status.SUCCESS if each else Status.TIMEOUT for each in won]
        made += rows(variant, path_of(struck, FACTORS), ends)
    return OutcomeTable(tuple(made))


@pytest.fixture(scope="module")
def drawn() -> dict[tuple[str, tuple[str, ...]], np.ndarray]:
    """The baseline fails under the observer's fault alone; the repair by chance."""
    rng = np.random.default_rng(3)
    found = {}
    for struck in subsets(FACTORS):
        held = "observer" in struck and "controller" not in struck
        found[BASELINE, struck] = rng.uniform(size=60) < (0.1 if held else 0.9)
        found[REPAIR, struck] = rng.uniform(size=60) < 0.6
    return found


def test_effects_are_differences_of_means_over_all_other_combinations(drawn):
    found = factorial(question(60), FACTORS, table(drawn))
    held = {(each.of, each.factors): each for each in found.effects}
    assert len(held) == len(found.effects) == found.hypotheses == 3 * 7
    rates = {
        "baseline": {s: 100 * drawn[BASELINE, s].mean() for s in subsets(FACTORS)},
        "repair": {s: 100 * drawn[REPAIR, s].mean() for s in subsets(FACTORS)},
    }
    rates["difference"] = {s: rates["repair"][s] - rates["baseline"][s] for s in rates["repair"]}
    for of, rate in rates.items():
        for factor in FACTORS:
            with_it = np.mean([v for s, v in rate.items() if factor in s])
            without = np.mean([v for s, v in rate.items() if factor not in s])
            assert held[of, (factor,)].effect.value == pytest.approx(with_it - without)

        def main(struck: bool, rate=rate) -> float:
            """Effect of the observer where the controller is struck, or is not."""
            cells = {s: v for s, v in rate.items() if ("controller" in s) is struck}
            return np.mean([v for s, v in cells.items() if "observer" in s]) - np.mean(
                [v for s, v in cells.items() if "observer" not in s]
            )

        half = (main(True) - main(False)) / 2
        assert held[of, ("controller", "observer")].effect.value == pytest.approx(half)


def test_what_is_detected_is_what_was_put_in(drawn):
    found = factorial(question(60), FACTORS, table(drawn))
    signs = {(each.of, each.factors): each.sign for each in found.effects}
    assert signs["baseline", ("observer",)] == -1
    assert signs["baseline", ("controller", "observer")] == 1
    assert signs["difference", ("controller", "observer")] == -1
    assert not any(sign for (of, _), sign in signs.items() if of == "repair")
    assert any("interaction of controller × observer on old is detected" in s for s in found.words)
    for each in found.effects:
        low, high = each.effect.interval
        assert low <= each.effect.value <= high
        assert each.adjusted_p_value >= each.p_value


def test_the_arms_change_places_and_so_do_the_signs(drawn):
    swap = {BASELINE: REPAIR, REPAIR: BASELINE}
    there = factorial(question(60), FACTORS, table(drawn))
    back = factorial(
        question(60), FACTORS, table({(swap[v], s): won for (v, s), won in drawn.items()})
    )
    one = {e.factors: e for e in there.effects if e.of == "difference"}
    for each in back.effects:
        if each.of == "difference":
            assert each.effect.value == -one[each.factors].effect.value
            assert each.sign == -one[each.factors].sign


def test_too_few_scenes_decide_nothing_and_say_so(drawn):
    few = table({key: won[:5] for key, won in drawn.items()})
    found = factorial(question(5), FACTORS, few)
    assert not any(each.sign for each in found.effects)
    assert found.words[0].startswith(
        "With 5 scenes no factorial effect can be detected: that takes"
    )


def test_nothing_detected_is_said():
    calm = {(v, s): np.ones(40, bool) for v, s in product((BASELINE, REPAIR), subsets(FACTORS))}
    assert factorial(question(40), FACTORS, table(calm)).words[0] == (
        "No factorial effect is detected."
    )


def test_arms_without_a_pair_leave_no_effects():
    made = []
    for variant, struck in product((BASELINE, REPAIR), subsets(FACTORS)):
        lost = struck == ("observer", "planner")
        ends = [Status.FAILED if lost else Status.SUCCESS] * 8
        made += rows(variant, path_of(struck, FACTORS), ends)
    found = factorial(question(8), FACTORS, OutcomeTable(tuple(made)))
    assert found.effects == ()
    assert found.words == (
        "No pair is left where observer+planner is struck: no factorial effects.",
    )
