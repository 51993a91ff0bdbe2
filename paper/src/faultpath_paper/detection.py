"""What the paper's rules detect in one contrast, uncorrected, and what they could detect."""

import math
from dataclasses import dataclass, replace

from faultpath.stats.contrast import Contrast
from faultpath.stats.distributions import normal_quantile
from faultpath.stats.estimate import Sign
from faultpath.stats.power import MIN_SCENES, detectable
from faultpath.stats.resamples import ROUNDING


@dataclass(frozen=True, eq=False)
class Difference(Contrast):
    """A contrast that a statement is about."""

    telling: float = math.inf
    """Size that has to be detectable before "not significant" says anything."""


def resampled(contrast: Contrast) -> Contrast:
    """Return a contrast with the percentile interval of its draws in place of the score interval.

    The paper reports that one. With few discordant scenes it is too narrow.
    """
    if contrast.scenes is None:
        return contrast
    return replace(contrast, scenes=None, method="percentile bootstrap of scenes")


def enough(contrast: Contrast) -> bool:
    """Return whether there are enough scenes for anything to be significant."""
    return contrast.n_scenes >= MIN_SCENES


def significant_side(contrast: Contrast) -> Sign:
    """Return the side of 0 on which interval and test agree, or 0; without a test, the interval's.

    It is at the level of this one test, without correction for others.
    """
    side = contrast.sign_of_interval
    if contrast.test is None:
        return side if enough(contrast) else 0
    return side if contrast.test.rejects() and contrast.test.leans == side else 0


def detection(contrast: Contrast) -> Sign:
    """Return the side of 0 on which the paper detects a difference, or 0.

    The whole interval lies there, of one seed's success with exact McNemar on its side.
    """
    if contrast.n_seeds == 1:
        return significant_side(contrast)
    return contrast.sign_of_interval if enough(contrast) else 0


def least_detectable(contrast: Contrast) -> float | None:
    """Return the least difference from 0 that has 80 % power, in the contrast's unit.

    None where no difference has, or where 0 does not mean "no difference".
    """
    if contrast.pairs is not None:
        return detectable(contrast.pairs, test="conditional")
    if not (contrast.against_zero and enough(contrast) and contrast.interval):
        return None
    half_width = normal_quantile(0.975)  # of a 95 % interval, in standard errors
    low, high = contrast.interval
    # The ends of a bootstrap interval tell less of its spread than its draws do.
    bounded = contrast.scenes is not None
    error = (high - low) / (2.0 * half_width) if bounded else float(contrast.draws.std())
    return (half_width + normal_quantile(0.8)) * error if error > ROUNDING else None
