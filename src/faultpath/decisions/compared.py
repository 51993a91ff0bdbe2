"""Trials of two variants that are compared, path by path, and what failed ones leave open."""

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
    """Outcomes that failed trials leave open on a path, over all scenes whose conditions agree.

    Where the trials of both arms failed neither is favoured, and both count as no success; where
    that of one did, it could have gone either way.
    """

    failed: tuple[int, int]
    """Failed trials of the repair and of the baseline."""
    alone: tuple[int, int]
    """Pairs in which only that of the repair failed, or only that of the baseline."""
    open: int
    """Pairs that could have gone either way."""
    against: Arms
    """Success, where what is open goes against the repair."""
    favour: Arms
    """Success, where it goes for the repair."""

    @property
    def uneven(self) -> bool:
        """Whether one arm failed more often than chance explains."""
        return sign_p_value(*self.alone) <= ALPHA


@dataclass(frozen=True)
class ComparedTrials:
    """Trials that are compared, path by path, and paths that are not."""

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
    def n_scenes(self) -> int:
        """Number of scenes that every path compared has."""
        return len(next(iter(self.pairs.values())).scenes)


def compared(
    repair: str,
    baseline: str,
    paths: Iterable[str],
    table: OutcomeTable,
    distinct: bool = True,
    judged: bool = False,
) -> ComparedTrials:
    """Return the trials of two variants that are compared; `UserError` when no scene is left.

    With `distinct`, one of several seeds with the same outcomes is kept. A sequential audit keeps
    all: which of them differ is only seen later, and the value of a scene must not change then.
    Where trials are `judged` that other tools ran, a pair that is missing in both arms could have
    gone either way too.
    """
    pairs = {path: pair(table, Side(repair, path), Side(baseline, path)) for path in paths}
    mismatches = tuple(mismatch for path in pairs.values() for mismatch in path.mismatches)
    left = dict(pairs)
    # A fault under which every trial fails must not cost what the other paths show: those with the
    # fewest pairs go first.
    scenes = {row.outcome.scene for row in table.rows}
    while not (kept := scenes.intersection(*(paired.scenes for paired in left.values()))):
        faulty = [name for name in left if name != CORRECT]
        if len(left) == 1 or not left[CORRECT].scenes:
            raise UserError(
                "no scene is left to compare, because in each of them a trial failed or the two "
                "versions met different conditions: mend what made it fail, or choose other scenes."
                + "".join(f" {words}" for words in mismatch_words(mismatches))
            )
        del left[min(faulty, key=lambda name: len(left[name].scenes))]
    cut = {name: paired.only(tuple(kept)) for name, paired in left.items()}
    unlike = {mismatch.scene for paired in left.values() for mismatch in paired.mismatches}
    alike = np.array([scene not in unlike for scene in next(iter(left.values())).all_scenes])
    seeds = _seeds(left, alike, distinct)
    failed = any(side.failed.any() for paired in left.values() for side in paired.ended)
    return ComparedTrials(
        pairs=cut,
        arms={
            name: (paired.first.success[:, seeds], paired.second.success[:, seeds])
            for name, paired in cut.items()
        },
        void=tuple(name for name in pairs if name not in left),
        mismatches=mismatches,
        voids={name: _void(paired, alike, seeds, judged) for name, paired in left.items()}
        if failed
        else {},
    )


def _seeds(left: Mapping[str, Pairs], alike: Bools, distinct: bool) -> list[int]:
    """Return the seeds that count: all, or the first of those that gave the same.

    Seeds repeat each other where their trials failed alike, too: what is missing of one is open.
    """
    ended = [side for paired in left.values() for side in paired.ended]
    every = np.concatenate([part[alike] for side in ended for part in (side.success, side.failed)])
    if not distinct:
        return list(range(every.shape[1]))
    first = {column.tobytes(): seed for seed, column in reversed(list(enumerate(every.T)))}
    return sorted(first.values())


def _void(paired: Pairs, alike: Bools, seeds: list[int], judged: bool) -> Voids:
    ours, theirs = (side.failed for side in paired.ended)
    our_successes, their_successes = (side.success[alike][:, seeds] for side in paired.ended)
    alone = ours & ~theirs, theirs & ~ours
    could = (ours, theirs) if judged else alone
    return Voids(
        failed=(int(ours.sum()), int(theirs.sum())),
        alone=(int(alone[0].sum()), int(alone[1].sum())),
        open=int((could[0] | could[1]).sum()),
        against=(our_successes, their_successes | could[1][alike][:, seeds]),
        favour=(our_successes | could[0][alike][:, seeds], their_successes),
    )
