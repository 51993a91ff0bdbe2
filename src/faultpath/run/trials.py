"""All trials of a run as arrays, one row a trial, and an index of what was planned into them."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import compress
from typing import Self

import numpy as np
from numpy.typing import NDArray

from faultpath.system.declared import SceneRef
from faultpath.system.outcome import Outcome, Status

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Rows = NDArray[np.int64]
"""Rows of trials; -1 where none was planned."""

STATUSES = tuple(Status)
HASHES = {
    "initial_hash": "initial states",
    "disturbance_hash": "disturbances",
    "planner_noise_hash": "planner noise",
}
"""Hashes of what a trial meets, each with what it is of: two trials are a pair only where these
agree."""
TEXTS = (*HASHES, "trajectory_hash")
_MOST_CELLS, _MOST_EMPTY = 10_000_000, 50
"""Cells of an index, and cells for each trial in a larger one: no plan is as sparse as that, and a
file of few trials cannot ask for all memory."""


@dataclass(frozen=True, slots=True)
class Trial:
    """One trial and where it stands in the plan."""

    variant: str
    condition: str
    seed: int
    scene_index: int
    topology: str
    outcome: Outcome


@dataclass(frozen=True, eq=False)
class Trials:
    """Outcomes of all trials `[rows]`, as run, and which of them was planned where."""

    variants: tuple[str, ...]
    conditions: tuple[str, ...]
    seeds: tuple[int, ...]
    scenes: tuple[SceneRef, ...]
    """By index."""
    index: Rows
    """`[variants, conditions, seeds, scenes]`: the row of each trial, -1 where none was planned."""
    status: NDArray[np.int8]
    """Places in `STATUSES`."""
    time_s: Floats
    """Not a number where other tools wrote none."""
    metrics: Mapping[str, Floats]
    """Not a number where a trial has none."""
    steps: NDArray[np.int64]
    """`[2, rows]`: control steps with a fault in force, and those that it altered."""
    texts: Mapping[str, NDArray[np.object_]]
    """The hashes of `TEXTS`."""
    errors: Mapping[int, str]
    """By row, of trials that have one."""
    traces: Mapping[int, NDArray[np.float32]]
    """Positions `[T, 3]`, metres, by row, of trials that have one."""

    @classmethod
    def of(cls, trials: Iterable[Trial]) -> Self:
        """Return the arrays of some trials.

        `ValueError` where two stand in one place, and for a plan that is almost all empty.
        """
        rows = tuple(trials)
        outcomes = [trial.outcome for trial in rows]
        refs: dict[str, SceneRef] = {}
        for trial in rows:
            if (scene := trial.outcome.scene) not in refs:
                refs[scene] = SceneRef(scene, trial.scene_index, trial.topology)
        scenes = tuple(sorted(refs.values(), key=lambda scene: scene.index))
        variants = tuple(dict.fromkeys(trial.variant for trial in rows))
        conditions = tuple(dict.fromkeys(trial.condition for trial in rows))
        seeds = tuple(dict.fromkeys(trial.seed for trial in rows))
        axes = (variants, conditions, seeds, [scene.id for scene in scenes])
        shape = [len(axis) for axis in axes]
        if math.prod(shape) > max(_MOST_CELLS, len(rows) * _MOST_EMPTY):
            raise ValueError("hardly any variant has a trial under the same condition and seed")
        places = [{label: place for place, label in enumerate(axis)} for axis in axes]
        labels = ((t.variant, t.condition, t.seed, t.outcome.scene) for t in rows)
        cells = [[axis[name] for axis, name in zip(places, of, strict=True)] for of in labels]
        index = np.full(shape, -1, np.int64)
        index[tuple(np.array(cells, np.int64).reshape(-1, 4).T)] = np.arange(len(rows))
        if int((index >= 0).sum()) != len(rows):
            raise ValueError("two trials have the same variant, condition, seed and scene")
        names = dict.fromkeys(name for outcome in outcomes for name in outcome.metrics)
        return cls(
            variants=variants,
            conditions=conditions,
            seeds=seeds,
            scenes=scenes,
            index=index,
            status=np.array([STATUSES.index(o.status) for o in outcomes], np.int8),
            time_s=np.array([o.time_s for o in outcomes], np.float64),
            metrics={
                name: np.array([o.metrics.get(name) for o in outcomes], np.float64)
                for name in names
            },
            steps=np.array([[o.faulted_steps, o.altered_steps] for o in outcomes], np.int64)
            .reshape(-1, 2)
            .T,
            texts={name: np.array([getattr(o, name) for o in outcomes], object) for name in TEXTS},
            errors={row: o.error for row, o in enumerate(outcomes) if o.error is not None},
            traces={row: o.trace for row, o in enumerate(outcomes) if o.trace is not None},
        )

    def __len__(self) -> int:
        return len(self.status)

    def __iter__(self) -> Iterator[Trial]:
        """Yield each trial by itself, in order."""
        places: list[list[int]] = self.places.tolist()
        for row, (variant, condition, seed, scene) in enumerate(places):
            ref = self.scenes[scene]
            yield Trial(
                self.variants[variant],
                self.conditions[condition],
                self.seeds[seed],
                ref.index,
                ref.topology,
                self.outcome(row, ref.id),
            )

    @cached_property
    def places(self) -> Rows:
        """`[rows, 4]`: variant, condition, seed and scene of each row, as places in these."""
        planned = np.argwhere(self.index >= 0)
        places = np.empty_like(planned)
        places[self.index[self.index >= 0]] = planned
        return places

    def outcome(self, row: int, scene: str) -> Outcome:
        """Return the outcome in a row, which is of `scene`."""
        faulted, altered = self.steps[:, row].tolist()
        values = {name: float(column[row]) for name, column in self.metrics.items()}
        return Outcome(
            scene=scene,
            status=STATUSES[int(self.status[row])],
            time_s=float(self.time_s[row]),
            metrics={name: value for name, value in values.items() if value == value},
            faulted_steps=faulted,
            altered_steps=altered,
            error=self.errors.get(row),
            trace=self.traces.get(row),
            **{name: str(texts[row]) for name, texts in self.texts.items()},
        )

    def outcomes(self, variant: str, condition: str, seed: int) -> list[Outcome]:
        """Return the outcomes of a variant under a condition with one seed, by scene."""
        rows: list[int] = self.rows(variant, condition, [seed])[0].tolist()
        places = zip(rows, self.scenes, strict=True)
        return [self.outcome(row, scene.id) for row, scene in places if row >= 0]

    def has(self, status: Status) -> Bools:
        """Return `[rows]` whether a trial ended so."""
        return np.asarray(self.status == STATUSES.index(status), dtype=np.bool_)

    @property
    def failed(self) -> Bools:
        """`[rows]`: whether the program raised an error or died."""
        return self.has(Status.FAILED)

    def met(self) -> Iterator[tuple[str, tuple[str, ...]]]:
        """Yield the scene of each trial that ran, and the hashes of what it met there."""
        hashes = zip(*(self.texts[name] for name in HASHES), strict=True)
        scenes: list[int] = self.places[:, 3].tolist()
        for scene, met, failed in zip(scenes, hashes, self.failed, strict=True):
            if not failed:
                yield self.scenes[scene].id, met

    def seeds_of(self, variant: str, condition: str) -> tuple[int, ...]:
        """Return the seeds of a variant under a condition, in the order of the plan."""
        planned: list[bool] = np.any(self.planned(variant, condition) >= 0, axis=1).tolist()
        return tuple(compress(self.seeds, planned))

    def rows(self, variant: str, condition: str, seeds: Sequence[int] | None = None) -> Rows:
        """Return the rows `[seeds, scenes]` of a variant under a condition, -1 where none is.

        `seeds` are those that were planned there when left out. `KeyError` for one without trials.
        """
        planned = self.seeds_of(variant, condition)
        chosen = planned if seeds is None else seeds
        for seed in chosen:
            if seed not in planned:
                raise KeyError(seed)
        return self.planned(variant, condition)[[self.seeds.index(seed) for seed in chosen]]

    def planned(self, variant: str, condition: str) -> Rows:
        """Return the rows of a variant under a condition with all seeds of the plan."""
        if variant not in self.variants or condition not in self.conditions:
            return np.full((len(self.seeds), len(self.scenes)), -1, np.int64)
        return self.index[self.variants.index(variant), self.conditions.index(condition)]
