"""Two arms over the same scenes; a pair that did not meet the same conditions is void."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import compress, product

import numpy as np
from numpy.typing import NDArray

from faultpath.core.errors import UserError
from faultpath.trials.outcome import Outcome, Status
from faultpath.trials.table import OutcomeTable, TrialRow

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]

_HASHES = {
    "initial_hash": "initial states",
    "disturbance_hash": "disturbances",
    "planner_noise_hash": "planner noise",
}


class PairingRefused(UserError):
    """Two sides that were to be compared do not hold the same seeds and scenes."""


@dataclass(frozen=True)
class Side:
    """One side of a contrast: a variant on a path."""

    variant: str
    path: str
    once: int | None = None
    """Seed of the only run of what no seed trains anew; that run is paired with every seed."""

    def __str__(self) -> str:
        return f"{self.variant} under {self.path}"

    def at(self, seed: int) -> int:
        """Return the seed of the trials that stand for `seed`."""
        return seed if self.once is None else self.once


@dataclass(frozen=True)
class Trials:
    """The trials of one side; every array is `[scenes, seeds]`."""

    success: Bools
    crash: Bools
    failed: Bools
    time_s: Floats
    metrics: Mapping[str, Floats]
    """Those that any of the trials has; not a number where one has not."""

    def only(self, keep: Bools) -> "Trials":
        """Return the scenes where `keep` `[scenes]` is true."""
        return Trials(
            self.success[keep],
            self.crash[keep],
            self.failed[keep],
            self.time_s[keep],
            {name: values[keep] for name, values in self.metrics.items()},
        )


@dataclass(frozen=True)
class Mismatch:
    """Two trials of a scene that met different conditions and are no pair."""

    first: Side
    second: Side
    scene: str
    seed: int
    differences: tuple[tuple[str, str, str], ...]
    """The name of each hash that differs, and both of its values."""

    def __str__(self) -> str:
        hashes = "; ".join(f"{name} {a[:8]!r} and {b[:8]!r}" for name, a, b in self.differences)
        what = " and ".join(_HASHES[name] for name, _, _ in self.differences)
        return (
            f"{self.first} and {self.second} are no pair in scene {self.scene!r} (seed "
            f"{self.seed}): their {what} differ ({hashes})"
        )


def mismatch_words(mismatches: Sequence[Mismatch]) -> tuple[str, ...]:
    """Return one sentence that counts the mismatches and shows the first; nothing without any."""
    if not mismatches:
        return ()
    first, *more = mismatches
    others = f"; so do those of {len(more)} other pair{'s' * (len(more) > 1)}" if more else ""
    return (f"{first}{others}.",)


@dataclass(frozen=True)
class Pairs:
    """Paired trials without the void ones.

    A pair is void where a trial failed, or where the two met different conditions. A scene with a
    void pair in any seed is left out whole, so that the arrays stay rectangular and every seed is
    seen over the same scenes; `void` counts the pairs.
    """

    scenes: tuple[str, ...]
    scene_indices: tuple[int, ...]
    seeds: tuple[int, ...]
    first: Trials
    second: Trials
    void: int
    all_scenes: tuple[str, ...]
    ended: tuple[Trials, Trials]
    """Trials of both sides, over `all_scenes`, void pairs included."""
    mismatches: tuple[Mismatch, ...] = ()
    """The pairs that are void because their trials met different conditions."""

    def only(self, scenes: Iterable[str]) -> "Pairs":
        """Return the pairs of `scenes`, to cut several contrasts to what all of them have."""
        selection = set(scenes)
        keep = np.array([scene in selection for scene in self.scenes], dtype=np.bool_)
        return replace(
            self,
            scenes=tuple(compress(self.scenes, keep)),
            scene_indices=tuple(compress(self.scene_indices, keep)),
            first=self.first.only(keep),
            second=self.second.only(keep),
        )


def pair(
    table: OutcomeTable,
    first: Side,
    second: Side,
    seeds: Sequence[int] | None = None,
    *,
    other_noise: bool = False,
) -> Pairs:
    """Pair two sides scene by scene and seed by seed.

    `seeds` are those of the first side when left out. `other_noise` says that the sides are
    planners that draw differently, by number of candidates for one: their noise is not compared.
    Nor is it where one side was run once, with another seed.
    Two trials that differ in their initial state, their disturbance or the planner's noise are no
    pair: it is void and among the `mismatches`. `PairingRefused` when the sides do not hold the
    same seeds and scenes.
    """
    seeds = table.seeds(first.variant, first.path) if seeds is None else tuple(seeds)
    if not seeds:
        raise PairingRefused(f"cannot pair {first} with {second}: the table has no trial of it")
    ones, twos = list[tuple[TrialRow, ...]](), list[tuple[TrialRow, ...]]()
    every: list[str] = []
    for seed, (side, arms) in product(seeds, ((first, ones), (second, twos))):
        try:
            arm = table.arm(side.variant, side.path, side.at(seed))
        except KeyError:
            raise PairingRefused(
                f"the table has no trial of {side} with seed {side.at(seed)}"
            ) from None
        arms.append(arm)
        scenes = [row.outcome.scene for row in arm]
        every = every or scenes
        if scenes != every:
            odd = sorted(set(scenes) ^ set(every)) or every
            raise PairingRefused(
                f"cannot pair {first} with {second} (seed {seed}): they ran in different scenes, "
                f"for example {odd[0]!r}"
            )
    ended = _trials(ones), _trials(twos)
    void = ended[0].failed | ended[1].failed
    mismatches: list[Mismatch] = []
    for at, (seed, one, two) in enumerate(zip(seeds, ones, twos, strict=True)):
        drawn_alike = not other_noise and first.at(seed) == second.at(seed)
        hashes = [name for name in _HASHES if name != "planner_noise_hash" or drawn_alike]
        for scene, (a, b) in enumerate(zip(one, two, strict=True)):
            if differences := unlike(a.outcome, b.outcome, hashes):
                mismatches.append(Mismatch(first, second, a.outcome.scene, seed, differences))
                void[scene, at] = True
    keep: Bools = np.asarray(~void.any(axis=1), dtype=np.bool_)
    return Pairs(
        scenes=tuple(compress(every, keep)),
        scene_indices=tuple(row.scene_index for row in compress(ones[0], keep)),
        seeds=tuple(seeds),
        first=_trials([tuple(compress(arm, keep)) for arm in ones]),
        second=_trials([tuple(compress(arm, keep)) for arm in twos]),
        void=int(void.sum()),
        all_scenes=tuple(every),
        ended=ended,
        mismatches=tuple(mismatches),
    )


def unlike(
    a: Outcome, b: Outcome, hashes: Iterable[str] = _HASHES
) -> tuple[tuple[str, str, str], ...]:
    """Return the name of each hash in which two trials differ, and both of its values."""
    if a.failed or b.failed:
        return ()  # a failed trial has no conditions to compare; its pair is void anyway
    values = ((name, getattr(a, name), getattr(b, name)) for name in hashes)
    return tuple((name, one, two) for name, one, two in values if one != two)


def _trials(arms: Sequence[Sequence[TrialRow]]) -> Trials:
    outcomes = [[row.outcome for row in arm] for arm in arms]
    success, crash, failed = (
        np.array([[o.status is status for o in arm] for arm in outcomes], dtype=np.bool_).T
        for status in (Status.SUCCESS, Status.CRASH, Status.FAILED)
    )
    metrics: dict[str, Floats] = {
        name: np.array([[o.metrics.get(name) for o in arm] for arm in outcomes], np.float64).T
        for name in dict.fromkeys(name for arm in outcomes for o in arm for name in o.metrics)
    }
    time_s = np.array([[o.time_s for o in arm] for arm in outcomes], dtype=np.float64).T
    return Trials(success, crash, failed, time_s, metrics)
