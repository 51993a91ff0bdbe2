"""The smallest difference that a paired comparison could have detected.

Reported beside every "not detected", because not detecting a difference is not equivalence.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from faultpath.statistics.distributions import (
    binomial_cdf,
    binomial_pmf,
    clopper_pearson_upper,
    normal_quantile,
)
from faultpath.statistics.estimate import Detectable, Discordant
from faultpath.statistics.inputs import Floats, Numbers, paired, paired_binary
from faultpath.statistics.paired import discordant, scene_totals, sign_counts

# Below this many differing scenes the mean difference is too far from normal for 2.80 x SE.
MIN_DIFFERING_SCENES = 10


def mcnemar_power(
    n_scenes: int, discordant_rate: float, difference: float, alpha: float = 0.05
) -> float:
    """Return the exact power of the two-sided exact McNemar test.

    Each of ``n_scenes`` pairs is discordant with probability ``discordant_rate`` and the success
    probabilities differ by ``difference`` (fractions, |difference| <= discordant_rate). The number
    of discordant pairs is enumerated, and the binomial of their split is summed in closed form.
    """
    if n_scenes < 1 or not 0.0 <= abs(difference) <= discordant_rate <= 1.0:
        raise ValueError(
            f"need 0 <= |difference| <= discordant_rate <= 1 and scenes, got "
            f"{difference}, {discordant_rate} and {n_scenes}"
        )
    if discordant_rate == 0.0:
        return 0.0
    discordants = np.arange(n_scenes + 1)
    critical = _critical(n_scenes, alpha)
    favour = 0.5 * (1.0 + abs(difference) / discordant_rate)
    rejects = binomial_cdf(critical, discordants, favour)
    rejects = rejects + binomial_cdf(critical, discordants, 1.0 - favour)
    return float(binomial_pmf(discordants, n_scenes, discordant_rate) @ rejects)


@lru_cache(maxsize=64)
def _critical(n_scenes: int, alpha: float) -> NDArray[np.int64]:
    """Return per number of discordants the largest smaller count that rejects; -1: none does."""
    counts = np.arange(n_scenes + 1)
    below = binomial_cdf(counts, counts[:, np.newaxis], 0.5) <= alpha / 2.0  # [discordants, count]
    return below.sum(axis=1, dtype=np.int64) - 1


def detectable_success(
    counts: Discordant, *, alpha: float = 0.05, power: float = 0.8
) -> Detectable:
    """Return the smallest difference in success (pp) that exact McNemar detects, from one seed.

    The discordant rate is held at the observed one. Where no split of it reaches the power, it is
    raised to the difference itself (all discordants on one side), the least that the difference
    needs. Without any discordant pair the rate is the upper end of its 95 % Clopper-Pearson
    interval. ``counts`` needs ``n_pairs``.
    """
    n_scenes = counts.n_pairs
    if not n_scenes:
        raise ValueError("the detectable difference needs n_pairs, the number of all pairs")
    notes: list[str] = []
    rate = counts.total / n_scenes
    if counts.total == 0:
        rate = clopper_pearson_upper(0, n_scenes)
        notes.append(
            f"no discordant pair; its rate is at most {100.0 * rate:.1f} % (Clopper-Pearson)"
        )
    difference = _smallest_difference(n_scenes, rate, alpha, power)
    if difference is not None and difference > rate:
        rate = difference
        notes.append("discordant rate raised to the difference, all discordants on one side")
    return Detectable(
        value=None if difference is None else 100.0 * difference,
        reason=f"with {n_scenes} scenes exact McNemar cannot reject at {alpha:g} with power "
        f"{power:g}, whatever the difference"
        if difference is None
        else None,
        alpha=alpha,
        power=power,
        method="exact power of the exact McNemar test",
        n_scenes=n_scenes,
        discordant_rate=rate,
        note="; ".join(notes) or None,
    )


def _smallest_difference(n_scenes: int, rate: float, alpha: float, power: float) -> float | None:
    def reaches(difference: float) -> bool:
        return mcnemar_power(n_scenes, max(rate, difference), difference, alpha) >= power

    if not reaches(1.0):
        return None
    low, high = 0.0, 1.0
    while high - low > 1e-6:
        middle = (low + high) / 2.0
        low, high = (low, middle) if reaches(middle) else (middle, high)
    return high


def detectable_by_standard_error(
    first: Numbers,
    second: Numbers,
    unit: str,
    *,
    scale: float = 1.0,
    alpha: float = 0.05,
    power: float = 0.8,
) -> Detectable:
    """Return the normal approximation (2.80 standard errors for 0.05 and 80 %) for [scenes, seeds].

    The standard error is that of the mean of scene means, scenes being the sample; for success in
    pp use ``scale=100``. A zero standard error, or a single scene, gives a reason and no value.
    """
    n_seeds = paired(first, second)[0].shape[1]
    means: Floats = scale * scene_totals(first, second) / n_seeds
    spread = float(means.std(ddof=1)) if len(means) > 1 else 0.0
    multiple = normal_quantile(1.0 - alpha / 2.0) + normal_quantile(power)
    known = spread > 0.0
    return Detectable(
        value=multiple * spread / float(np.sqrt(len(means))) if known else None,
        reason=None if known else "the scene means do not vary, so there is no standard error",
        unit=unit,
        alpha=alpha,
        power=power,
        method=f"normal approximation, {multiple:.2f} x standard error of scene means",
        n_scenes=len(means),
        n_seeds=n_seeds,
    )


def detectable_by_sign_test(
    first: Numbers, second: Numbers, *, alpha: float = 0.05, power: float = 0.8
) -> Detectable:
    """Return the smallest difference in success (pp) that the sign test on scene means detects.

    Scenes that differ play the part of discordant pairs, and each contributes the mean size
    observed among them (1, the largest possible, when none differs).
    """
    one, two = paired_binary(first, second)
    n_seeds = one.shape[1]
    counts = sign_counts(one, two)
    totals = np.abs(scene_totals(one, two))
    size = float(totals[totals > 0].mean()) / n_seeds if counts.total else 1.0
    single = detectable_success(counts, alpha=alpha, power=power)
    notes = [f"a differing scene differs by {100.0 * size:.0f} pp on average"]
    return single.model_copy(
        update={
            "value": None if single.value is None else size * single.value,
            "method": "exact power of the sign test on scene means",
            "n_seeds": n_seeds,
            "note": "; ".join([*notes, single.note] if single.note else notes),
        }
    )


def detectable(
    first: Numbers, second: Numbers, *, alpha: float = 0.05, power: float = 0.8
) -> Detectable:
    """Return the detectable difference in success (pp) for binary arms [scenes, seeds].

    One seed: exact McNemar. Several: 2.80 standard errors of the scene means, or, where fewer
    than ``MIN_DIFFERING_SCENES`` scenes differ, the exact sign test.
    """
    one, two = paired_binary(first, second)
    if one.shape[1] == 1:
        return detectable_success(discordant(one, two), alpha=alpha, power=power)
    if sign_counts(one, two).total < MIN_DIFFERING_SCENES:
        return detectable_by_sign_test(one, two, alpha=alpha, power=power)
    return detectable_by_standard_error(one, two, "pp", scale=100.0, alpha=alpha, power=power)
