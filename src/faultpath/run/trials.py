"""All trials of a run as arrays, one row a trial, and an index of what was planned into them."""

import math
import sys
from array import array
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import compress
from typing import Any, Self

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
        axes: tuple[dict[Any, int], ...] = ({}, {}, {}, {})
        scenes: list[SceneRef] = []
        cells, steps, status, time_s = array("q"), array("q"), array("b"), array("d")
        metrics: dict[str, array[float]] = {}
        texts: dict[str, list[str]] = {name: [] for name in TEXTS}
        errors: dict[int, str] = {}
        traces: dict[int, NDArray[np.float32]] = {}
        for row, trial in enumerate(trials):  # one by one: as objects they would fill the memory
            outcome = trial.outcome
            labels = trial.variant, trial.condition, trial.seed, outcome.scene
            for axis, label in zip(axes, labels, strict=True):
                cells.append(axis.setdefault(label, len(axis)))
            if len(scenes) < len(axes[-1]):
                scenes.append(SceneRef(outcome.scene, trial.scene_index, trial.topology))
            status.append(STATUSES.index(outcome.status))
            time_s.append(outcome.time_s)
            steps.extend((outcome.faulted_steps, outcome.altered_steps))
            for name in outcome.metrics:
                if name not in metrics:
                    metrics[name] = array("d", [math.nan]) * row
            for name, values in metrics.items():
                value = outcome.metrics.get(name)
                values.append(math.nan if value is None else value)
            for name, column in texts.items():
                column.append(sys.intern(str(getattr(outcome, name))))
            if outcome.error is not None:
                errors[row] = outcome.error
            if outcome.trace is not None:
                traces[row] = outcome.trace
        variants, conditions, seeds = (tuple(axis) for axis in axes[:-1])
        order = sorted(range(len(scenes)), key=lambda place: scenes[place].index)
        index = _index_of(np.array(cells).reshape(-1, len(axes)), [len(axis) for axis in axes])
        return cls(
            variants=variants,
            conditions=conditions,
            seeds=seeds,
            scenes=tuple(scenes[place] for place in order),
            index=index[..., order],
            status=np.array(status),
            time_s=np.array(time_s),
            metrics={name: np.array(values) for name, values in metrics.items()},
            steps=np.array(steps).reshape(-1, 2).T,
            texts={name: np.array(column, object) for name, column in texts.items()},
            errors=errors,
            traces=traces,
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


def _index_of(cells: Rows, shape: Sequence[int]) -> Rows:
    """Return the row of each cell of a plan, from the cell of each row; raises as `Trials.of`."""
    if math.prod(shape) > max(_MOST_CELLS, len(cells) * _MOST_EMPTY):
        raise ValueError("hardly any variant has a trial under the same condition and seed")
    index = np.full(shape, -1, np.int64)
    index[tuple(cells.T)] = np.arange(len(cells))
    if int((index >= 0).sum()) != len(cells):
        raise ValueError("two trials have the same variant, condition, seed and scene")
    return index
