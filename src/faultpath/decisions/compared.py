"""Which trials an audit compares: the pairs of all paths, cut to what they have in common."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from faultpath.core.errors import UserError
from faultpath.decisions.model import CORRECT
from faultpath.statistics.distributions import sign_p_value
from faultpath.statistics.estimate import ALPHA
from faultpath.trials.pairing import Bools, Mismatch, Pairs, Side, mismatch_words, pair
from faultpath.trials.table import OutcomeTable

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
    against: Arms
    """Success, where what is open goes against the repair."""
    favour: Arms
    """Success, where it goes for the repair."""

    @property
    def uneven(self) -> bool:
        """Whether one arm failed more often than chance explains."""
        return sign_p_value(*self.alone) <= ALPHA


@dataclass(frozen=True)
class Compared:
    """What is compared, path by path, and what is not."""

    pairs: Mapping[str, Pairs]
    """All trials that are compared."""
    arms: Mapping[str, Arms]
    """Success, by the seeds that differ."""
    void: tuple[str, ...]
    """Paths of which no pair is left beside the others."""
    mismatches: tuple[Mismatch, ...]
    voids: Mapping[str, Voids]
    """By path, where a trial failed on any of them; else nothing."""

    @property
    def scenes(self) -> int:
        """Scenes that every path compared has."""
        return len(next(iter(self.pairs.values())).scenes)


def compared(
    repair: str, baseline: str, paths: Iterable[str], table: OutcomeTable, distinct: bool = True
) -> Compared:
    """Return the trials of two variants that are compared; `UserError` when no scene is left.

    Of seeds that repeat others one is kept, unless not only those that are `distinct` are asked
    for: a sequential audit keeps all, because which differ is only seen later, and the value of a
    scene has to be what it was when it was run.
    """
    pairs = {path: pair(table, Side(repair, path), Side(baseline, path)) for path in paths}
    mismatches = tuple(each for path in pairs.values() for each in path.mismatches)
    left = dict(pairs)
    # A fault under which every trial fails must not cost what the other paths show: those with the
    # fewest pairs go first.
    scenes = {row.outcome.scene for row in table.rows}
    while not (kept := scenes.intersection(*(each.scenes for each in left.values()))):
        faulty = [name for name in left if name != CORRECT]
        if not faulty or not left[CORRECT].scenes:
            raise UserError(
                "no scene is left to compare, because in each of them a trial failed or the arms "
                "met different conditions: mend what made it fail, or choose other scenes."
                + "".join(f" {words}" for words in mismatch_words(mismatches))
            )
        del left[min(faulty, key=lambda name: len(left[name].scenes))]
    cut = {name: each.only(tuple(kept)) for name, each in left.items()}
    success = {name: (each.first.success, each.second.success) for name, each in cut.items()}
    every = np.concatenate([arm for arms in success.values() for arm in arms])
    seeds = list(range(every.shape[1]))
    if distinct:
        first = {column.tobytes(): seed for seed, column in reversed(list(enumerate(every.T)))}
        seeds = sorted(first.values())
    voids: dict[str, Voids] = {}
    if any(side.failed.any() for each in left.values() for side in each.ended):
        unlike = {mismatch.scene for each in left.values() for mismatch in each.mismatches}
        every_scene = next(iter(left.values())).all_scenes
        keep = np.array([scene not in unlike for scene in every_scene])
        for name, each in left.items():
            ours, theirs = (side.failed for side in each.ended)
            won, lost = (side.success[keep][:, seeds] for side in each.ended)
            alone = ours & ~theirs, theirs & ~ours
            voids[name] = Voids(
                failed=(int(ours.sum()), int(theirs.sum())),
                alone=(int(alone[0].sum()), int(alone[1].sum())),
                against=(won, lost | alone[1][keep][:, seeds]),
                favour=(won | alone[0][keep][:, seeds], lost),
            )
    return Compared(
        pairs=cut,
        arms={name: (one[:, seeds], two[:, seeds]) for name, (one, two) in success.items()},
        void=tuple(name for name in pairs if name not in left),
        mismatches=mismatches,
        voids=voids,
    )
