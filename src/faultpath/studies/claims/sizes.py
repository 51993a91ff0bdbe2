"""Whether an effect is as large as the paper's: said beside an answer, and no part of it.

`docs/design/claims.md` gives the definition and its reasons.
"""

from math import hypot

from faultpath.record.reproduction import Size
from faultpath.statistics.contrast import ROUNDING
from faultpath.studies.claims.rules import Ends, points_decide
from faultpath.studies.published import Printed

NO_EFFECT = {"pp": 0.0, "s": 0.0, "m": 0.0, "m/s^2": 0.0, "times": 1.0}
"""By unit, its value. What has another unit, as a share of scenes has, has no sign."""


def size(
    value: float | None,
    interval: Ends | None,
    n_scenes: int,
    paper: Printed | None,
    no_effect: float | None,
) -> Size:
    """Set an estimate beside the paper's figure; `no_effect` is `None` where no sign is at stake.

    Compatible: the 95 % interval of ours minus the paper's holds 0. Else a sign counts where a
    whole interval shows it, ours and, where it prints one, the paper's.
    """
    if paper is None or value is None or interval is None or not points_decide(n_scenes):
        return "not comparable"
    theirs = paper.interval or (paper.value, paper.value)
    if _compatible(value, interval, paper.value, theirs):
        return "compatible"
    if no_effect is None:
        return "other size"
    own, printed = _side(interval, no_effect), _side(theirs, no_effect)
    if not (own and printed):
        return "other size"
    return "right sign, other size" if own == printed else "other sign"


def _compatible(ours: float, interval: Ends, paper: float, theirs: Ends) -> bool:
    """Return whether the interval of a difference of independent estimates holds 0.

    It is made from both intervals without taking them to be symmetric (MOVER: Zou and Donner,
    Statistics in Medicine 27, 2008).
    """
    difference = ours - paper
    low = difference - hypot(ours - interval[0], theirs[1] - paper)
    high = difference + hypot(interval[1] - ours, paper - theirs[0])
    return low <= ROUNDING and high >= -ROUNDING


def _side(interval: Ends, of: float) -> int:
    return int(interval[0] > of) - int(interval[1] < of)
