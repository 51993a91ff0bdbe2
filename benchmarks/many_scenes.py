"""Two numbers of scenes, side by side: what an audit's tests cost has to grow as the scenes do."""

from itertools import count

from benchmarks.side import Side
from faultpath.analyses.family import decide_conditions
from faultpath.analyses.model import CORRECT, SHARED
from faultpath.core.streams import generator
from faultpath.stats.breakeven import break_even
from faultpath.stats.power import detectable

SUCCESS = {CORRECT: (0.59, 0.6), "observer": (0.6, 0.35), SHARED: (0.4, 0.6)}
"""Under three conditions, of repair and baseline."""


def tests(scenes: int) -> Side:
    """Effects, changes, power and a break-even frequency of one seed under three conditions; the
    unit is a scene."""
    draws = generator("benchmark-many-scenes", "all", 0)
    hardness = draws.random(scenes)
    outcomes = {
        condition: tuple(0.7 * hardness + 0.3 * draws.random(scenes) < rate for rate in rates)
        for condition, rates in SUCCESS.items()
    }
    left_out = count()

    def work() -> None:
        kept = slice(next(left_out), None)  # a number of scenes of which nothing is cached
        success = {
            condition: (repair[kept, None] * 1.0, baseline[kept, None] * 1.0)
            for condition, (repair, baseline) in outcomes.items()
        }
        family = decide_conditions(success)
        for effect in family.effects.values():
            assert effect.pairs is not None
            detectable(effect.pairs, on_top=True)
        break_even(family.effects[CORRECT], family.effects[SHARED])

    return Side(work, scenes)
