"""What trials that failed leave open: they have no outcome, and might have had either."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.results import Result
from faultpath.statistics import Contrast, Estimate, RuleName, with_test
from faultpath.statistics.distributions import sign_p_value
from faultpath.statistics.estimate import ALPHA, PairedTest

Bools: TypeAlias = NDArray[np.bool_]
Arms: TypeAlias = tuple[Bools, Bools]
"""Success of the repair and of the baseline, each `[scenes, seeds]`."""


@dataclass(frozen=True)
class Voids:
    """What failed trials leave open on one path, over all scenes whose conditions agree.

    Where the trials of both arms failed neither is favoured, and both count as no success; where
    that of one did, it could have gone either way.
    """

    failed: tuple[int, int]
    """Failed trials of the repair and of the baseline."""
    alone: tuple[int, int]
    """Pairs in which only that of the repair failed, or only that of the baseline."""
    as_failures: Arms
    """Success, where what failed counts as no success."""
    against: Arms
    """Success, where what is open goes against the repair."""
    favour: Arms
    """Success, where it goes for the repair."""

    @property
    def uneven(self) -> bool:
        """Whether one arm failed more often than chance explains."""
        return sign_p_value(*self.alone) <= ALPHA


class Fills(NamedTuple):
    """The effect of one path with what is open filled in."""

    as_failures: Contrast
    against: Contrast
    favour: Contrast


class FailedTrials(Result):
    """What failed trials leave open of an effect, as a record tells it."""

    repair: int
    """Failed trials of the repair on this path."""
    baseline: int
    as_failures: Estimate
    """The difference over all scenes, where what failed counts as no success."""
    against_pp: float
    """The difference where the trials of pairs of which one failed go against the repair."""
    favour_pp: float
    """Where they go for it."""
    uneven: bool
    """Whether one arm failed more often than chance explains: then no headline rests on it."""
    unsettled: bool
    """Whether the scenes compared decide for an arm, and what is open could undo that."""


def filled(
    all_voids: Mapping[str, Voids], fills: Mapping[str, Fills], path: str, unsettled: bool
) -> FailedTrials | None:
    """Return what failed trials leave open on a path; `None` where none failed on any."""
    if path not in fills:
        return None
    of, voids = fills[path], all_voids[path]
    return FailedTrials(
        repair=voids.failed[0],
        baseline=voids.failed[1],
        as_failures=of.as_failures.estimate(),
        against_pp=of.against.value,
        favour_pp=of.favour.value,
        uneven=voids.uneven,
        unsettled=unsettled,
    )


def nearest(against: Contrast, favour: Contrast, rule: RuleName) -> Contrast:
    """Return the tested contrast nearest to no difference that what is open allows."""
    low, high = with_test(against, rule), with_test(favour, rule)
    assert low.test is not None
    assert high.test is not None
    if low.test.leans > 0:
        return low
    return high if high.test.leans < 0 else replace(low, test=PairedTest(low.test.name, 1.0, 0))


def open_again(decided: Contrast) -> Contrast:
    """Return a contrast of which nothing is decided after all."""
    assert decided.decision is not None
    return replace(decided, decision=decided.decision._replace(sign=0))
