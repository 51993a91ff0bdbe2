"""The smallest difference that a paired comparison would have detected.

Reported beside every "not detected", because not detecting a difference is not equivalence. It is
that of the rule which decides: the test at the level that its family leaves it, and the interval.
There is none for newly trained models: a few trainings do not know their own spread.
"""

from collections.abc import Callable

import numpy as np

from faultpath.statistics.distributions import clopper_pearson_upper
from faultpath.statistics.estimate import ALPHA
from faultpath.statistics.inputs import Floats, Numbers, paired_binary
from faultpath.statistics.power import rule_power, seed_mixture, simulated_power
from faultpath.statistics.rules import RuleName

_PRECISION = 1e-3
_PRIOR_ALIKE, _PRIOR_SCENES = 0.5, 1.0
"""What is taken to have been seen of seeds that end alike, before anything was."""


def detectable(
    first: Numbers,
    second: Numbers,
    *,
    rule: RuleName,
    alpha: float = ALPHA,
    power: float = 0.8,
    on_top: bool = False,
) -> float | None:
    """Return the detectable difference in success (pp) of binary arms [scenes, seeds].

    None where the test cannot reject at ``alpha`` with that power, whatever the difference. As many
    pairs are taken to be discordant as were, or with all of them on one side what the difference
    needs; without any, the upper end of the 95 % Clopper-Pearson interval of their share. Seeds
    agree within a scene as often as was seen; copies of a seed count once.

    ``on_top`` takes what was seen for noise that favours neither arm, and the difference for wins
    beside it, so that pairs are discordant more often: the number to plan by.
    """
    one, two = paired_binary(first, second)
    n_scenes = len(one)
    seeds = np.unique(one - two, axis=1)
    rate, alike = float(np.abs(seeds).mean()), 1.0
    if rate == 0.0:
        rate = clopper_pearson_upper(0, n_scenes)
    elif seeds.shape[1] > 1:
        alike = _alike(seeds)

    def reached(difference: float) -> float:
        share = min(1.0, rate + difference if on_top else max(rate, difference))
        if alike == 1.0:
            return rule_power(n_scenes, share, difference, alpha, rule=rule)
        values, chances = seed_mixture(seeds.shape[1], share, difference / share, alike)
        return simulated_power(n_scenes, values, chances, alpha, rule)

    least = _least(lambda size: reached(size) >= power)
    return None if least is None else 100.0 * least


def _alike(seeds: Floats) -> float:
    """Return the share of scenes in which all seeds end alike, from differences [scenes, seeds].

    Two seeds' product has the mean ``alike * rate + (1 - alike) * mean ** 2``. A little is added
    as if seen, on either side, because few discordant pairs tell little.
    """
    n_scenes, n_seeds = seeds.shape
    pairs = n_seeds * (n_seeds - 1)
    products = float((seeds.sum(axis=1) ** 2 - np.abs(seeds).sum(axis=1)).sum()) / pairs
    by_chance = n_scenes * float(seeds.mean()) ** 2
    discordant = n_scenes * float(np.abs(seeds).mean())
    seen = discordant - by_chance + _PRIOR_SCENES
    return min(1.0, max(0.0, (products - by_chance + _PRIOR_ALIKE * _PRIOR_SCENES) / seen))


def _least(reaches: Callable[[float], bool]) -> float | None:
    if not reaches(1.0):
        return None
    low, high = 0.0, 1.0
    while high - low > _PRECISION * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if reaches(middle) else (middle, high)
    return high
