"""Two groups of trials, paired scene by scene and seed by seed."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import compress
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from faultpath.core.errors import UserError
from faultpath.run.findings import Unpaired
from faultpath.run.trials import HASHES, Bools, Floats, Rows, Trials
from faultpath.system.declared import SceneRef
from faultpath.system.outcome import Outcome, Status

_Value = TypeVar("_Value", bound=np.generic)


@dataclass(frozen=True)
class Group:
    """The trials of a variant under a condition."""

    variant: str
    condition: str
    once: int | None = None
    """Seed of the only run of what no seed trains anew; that run is paired with every seed."""

    def __str__(self) -> str:
        return f"{self.variant} under {self.condition}"

    def at(self, seed: int) -> int:
        """Return the seed of the trials that stand for `seed`."""
        return seed if self.once is None else self.once


@dataclass(frozen=True, eq=False)
class Pairs:
    """Trials of two groups, scene by scene and seed by seed."""

    trials: Trials
    scenes: tuple[SceneRef, ...]
    rows: tuple[Rows, Rows]
    """Those of the first and of the second group, `[seeds, scenes]`."""
    void: Bools
    """`[seeds, scenes]`: pairs that do not count, since a trial is missing or the two met different
    conditions."""
    unpaired: tuple[Unpaired, ...] = ()
    """Those that met different conditions."""

    @cached_property
    def success(self) -> tuple[Floats, Floats]:
        """Success of both groups `[scenes, seeds]`: 1 or 0, not a number where a trial failed."""
        ends = np.where(self.trials.failed, np.nan, self.trials.has(Status.SUCCESS))
        return self._of(ends)

    def ended(self, status: Status) -> tuple[Bools, Bools]:
        """Return `[scenes, seeds]` of both groups whether a trial ended so."""
        return self._of(self.trials.has(status))

    @property
    def time_s(self) -> tuple[Floats, Floats]:
        """Times of both groups `[scenes, seeds]`."""
        return self._of(self.trials.time_s)

    def metric(self, name: str) -> tuple[Floats, Floats] | None:
        """Return a metric of both groups `[scenes, seeds]`; `None` where one has it nowhere."""
        if name not in self.trials.metrics:
            return None
        values = self._of(self.trials.metrics[name])
        return None if any(np.isnan(part).all() for part in values) else values

    def _of(self, values: NDArray[_Value]) -> tuple[NDArray[_Value], NDArray[_Value]]:
        # By columns: the order of later sums, and with it their last bits, rests on it.
        first, second = (values[rows].T for rows in self.rows)
        return first, second

    def whole(self) -> "Pairs":
        """Return the pairs of the scenes in which all count: every seed over the same scenes."""
        return self._at(np.asarray(~self.void.any(axis=0), dtype=np.bool_))

    def only(self, scenes: Collection[str]) -> "Pairs":
        """Return the pairs of `scenes`, to cut several contrasts to what all of them have."""
        return self._at(np.array([scene.id in scenes for scene in self.scenes], dtype=np.bool_))

    def _at(self, keep: Bools) -> "Pairs":
        first, second = self.rows
        return replace(
            self,
            scenes=tuple(compress(self.scenes, keep)),
            rows=(first[:, keep], second[:, keep]),
            void=self.void[:, keep],
        )


def pair(
    trials: Trials,
    first: Group,
    second: Group,
    seeds: Sequence[int] | None = None,
    *,
    other_noise: bool = False,
) -> Pairs:
    """Pair two groups scene by scene and seed by seed.

    `seeds` are those of the first group when left out. `other_noise` says that the two are planners
    that draw differently, by number of candidates for one: their noise is not compared. Nor is it
    where one of them was run once, with another seed.
    Two trials that differ in their initial state, their disturbance or the planner's noise are no
    pair and among the `unpaired`. `UserError` when the groups hold other seeds or scenes.
    """
    seeds = trials.seeds_of(first.variant, first.condition) if seeds is None else tuple(seeds)
    if not seeds:
        raise UserError(f"cannot pair {first} with {second}: the table has no trial of it")
    one, two = (_rows(trials, group, seeds) for group in (first, second))
    planned = np.concatenate([one >= 0, two >= 0])
    chosen = np.asarray(planned.any(axis=0))
    if (partly := chosen & ~planned.all(axis=0)).any():
        raise UserError(
            f"cannot pair {first} with {second}: they ran in different scenes, for example "
            f"{trials.scenes[int(partly.argmax())].id!r}"
        )
    one, two = one[:, chosen], two[:, chosen]
    scenes = tuple(compress(trials.scenes, chosen))
    void = trials.failed[one] | trials.failed[two]
    unpaired: list[Unpaired] = []
    for place, seed in enumerate(seeds):
        drawn_alike = not other_noise and first.at(seed) == second.at(seed)
        hashes = [name for name in HASHES if name != "planner_noise_hash" or drawn_alike]
        rows = np.stack([one[place], two[place]])
        values = {name: trials.texts[name][rows] for name in hashes}
        unlike = np.any([both[0] != both[1] for both in values.values()], axis=0) & ~void[place]
        unlike_scenes: list[int] = np.flatnonzero(unlike).tolist()
        for scene in unlike_scenes:
            hashed = ((name, *map(str, both[:, scene])) for name, both in values.items())
            unpaired.append(
                Unpaired(
                    first=(first.variant, first.condition),
                    second=(second.variant, second.condition),
                    scene=scenes[scene].id,
                    seed=seed,
                    differences=tuple((name, a, b) for name, a, b in hashed if a != b),
                )
            )
        void[place] |= unlike
    return Pairs(trials, scenes, (one, two), void, tuple(unpaired))


def _rows(trials: Trials, group: Group, seeds: Sequence[int]) -> Rows:
    try:
        return trials.rows(group.variant, group.condition, [group.at(seed) for seed in seeds])
    except KeyError as error:
        raise UserError(f"the table has no trial of {group} with seed {error.args[0]}") from None


def unlike(a: Outcome, b: Outcome) -> tuple[tuple[str, str, str], ...]:
    """Return the name of each hash in which two trials differ, and both of its values."""
    if a.failed or b.failed:
        return ()  # a failed trial has no conditions to compare; its pair does not count anyway
    values = ((name, getattr(a, name), getattr(b, name)) for name in HASHES)
    return tuple((name, one, two) for name, one, two in values if one != two)
