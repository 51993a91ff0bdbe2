"""Which trials an audit compares: the pairs of all paths, cut to what they have in common."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faultpath.errors import UserError
from faultpath.record.family import CORRECT
from faultpath.record.voids import Arms, Voids
from faultpath.trials.pairing import Bools, Mismatch, Pairs, Side, mismatch_words, pair
from faultpath.trials.table import OutcomeTable


@dataclass(frozen=True)
class PathTrials:
    """The trials of one path: all that are compared, and success by the seeds that differ."""

    pairs: Pairs
    arms: Arms


@dataclass(frozen=True)
class Compared:
    """What is compared, path by path, and what is not."""

    trials: Mapping[str, PathTrials]
    void: tuple[str, ...]
    """Paths of which no pair is left beside the others."""
    mismatches: tuple[Mismatch, ...]
    voids: Mapping[str, Voids]
    """By path, where a trial failed on any of them; else nothing."""

    @property
    def scenes(self) -> int:
        """Scenes that every path compared has."""
        return len(next(iter(self.trials.values())).pairs.scenes)

    @property
    def seeds(self) -> tuple[int, int]:
        """How many seeds were run and how many of them differ."""
        first = next(iter(self.trials.values()))
        return first.pairs.first.success.shape[1], first.arms[0].shape[1]


def compared(
    repair: str,
    baseline: str,
    paths: Iterable[str],
    table: OutcomeTable,
    distinct: bool = True,
) -> Compared:
    """Return the trials of two variants that are compared; `UserError` when no scene is left.

    Of seeds that repeat others one is kept; all of them where not only those that are `distinct`
    are asked for.
    """
    pairs = {path: pair(table, Side(repair, path), Side(baseline, path)) for path in paths}
    mismatches = tuple(each for path in pairs.values() for each in path.mismatches)
    left = _comparable(pairs, mismatches)
    void = tuple(name for name in pairs if name not in left)
    trials, seeds = _trials(left, distinct)
    return Compared(trials, void, mismatches, _voids(left, seeds))


def _comparable(pairs: Mapping[str, Pairs], mismatches: Sequence[Mismatch]) -> dict[str, Pairs]:
    """Return the paths that have scenes in common: those with the fewest pairs go first.

    A fault under which every trial fails must not cost what the other paths show.
    """
    left = dict(pairs)
    while not _shared_scenes(left.values()):
        faulty = [name for name in left if name != CORRECT]
        if not faulty or not left[CORRECT].scenes:
            raise UserError(
                "no scene is left to compare, because in each of them a trial failed or the arms "
                "met different conditions: mend what made it fail, or choose other scenes."
                + "".join(f" {words}" for words in mismatch_words(mismatches))
            )
        del left[min(faulty, key=lambda name: len(left[name].scenes))]
    return left


def _shared_scenes(pairs: Iterable[Pairs]) -> tuple[str, ...]:
    first, *others = pairs
    every = [set(each.scenes) for each in others]
    return tuple(scene for scene in first.scenes if all(scene in scenes for scenes in every))


def _trials(
    pairs: Mapping[str, Pairs], distinct: bool
) -> tuple[dict[str, PathTrials], Sequence[int]]:
    """Cut all paths to the scenes that every one has, and success to the seeds that differ.

    A sequential audit keeps all seeds: which of them differ is only seen later, and the value of a
    scene has to be what it was when it was flown.
    """
    kept = _shared_scenes(pairs.values())
    cut = {name: each.only(kept) for name, each in pairs.items()}
    arms = [arm.success for each in cut.values() for arm in (each.first, each.second)]
    seeds = _distinct(arms) if distinct else list(range(arms[0].shape[1]))
    trials = {
        name: PathTrials(each, (each.first.success[:, seeds], each.second.success[:, seeds]))
        for name, each in cut.items()
    }
    return trials, seeds


def _voids(pairs: Mapping[str, Pairs], seeds: Sequence[int]) -> dict[str, Voids]:
    if not any(side.failed.any() for each in pairs.values() for side in each.ended):
        return {}
    unlike = {mismatch.scene for each in pairs.values() for mismatch in each.mismatches}
    scenes = next(iter(pairs.values())).all_scenes
    keep = np.array([scene not in unlike for scene in scenes])
    found: dict[str, Voids] = {}
    for name, each in pairs.items():
        first, second = each.ended
        repair, baseline = (side.success[keep][:, seeds] for side in each.ended)
        alone = first.failed & ~second.failed, second.failed & ~first.failed
        ours, theirs = (side[keep][:, seeds] for side in alone)
        found[name] = Voids(
            failed=(int(first.failed.sum()), int(second.failed.sum())),
            alone=(int(alone[0].sum()), int(alone[1].sum())),
            as_failures=(repair, baseline),
            against=(repair, baseline | theirs),
            favour=(repair | ours, baseline),
        )
    return found


def _distinct(arms: Sequence[Bools]) -> list[int]:
    stacked = np.concatenate(arms)
    seen: dict[bytes, int] = {}
    for seed, column in enumerate(stacked.T):
        seen.setdefault(column.tobytes(), seed)
    return list(seen.values())
