"""A plant whose scenes are episodes: each runs until it ends, and then keeps its final state."""

from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from typing_extensions import override

from faultpath.core.arrays import HostArray, to_numpy
from faultpath.core.error_source import mistake_in
from faultpath.core.errors import SystemMistake
from faultpath.core.text import listed, unknown
from faultpath.loop import Batch, Inputs, Plant, Port, Progress
from faultpath.system.arguments import boolean_of, check_episode, number_of, shown
from faultpath.system.observed import Selector, select
from faultpath.system.outcome import Metric

SCENE = "seed/"
"""Prefix of a scene's name, which holds the seed of its reset: `seed/7`."""


@dataclass(frozen=True)
class Episode:
    """One finished trial, as `succeeded` and metrics get it.

    `episode["angle"]` are the values of the source `angle` at the start and after each step,
    `[T + 1, ...]`. A source with more than one axis, such as an image, keeps only its last value,
    `[1, ...]`.
    """

    signals: Mapping[str, HostArray]
    rewards: HostArray
    """`[T]`; zeros where there are none."""
    terminated: bool
    """Whether the environment ended it, successfully or not; else it reached the time limit."""
    info: Mapping[str, Any]
    """Info that the environment returned at the last step."""
    dt_s: float

    def __getitem__(self, source: str) -> HostArray:
        """Return the values of a source; `SystemMistake` for an unknown one."""
        if source not in self.signals:
            raise SystemMistake(f"an episode: {unknown('source', source, self.signals)}")
        return self.signals[source]

    @property
    def returned(self) -> float:
        """Sum of the rewards."""
        return float(self.rewards.sum())


@dataclass(frozen=True)
class SceneInstance:
    """One scene at its start, made for one trial."""

    observation: Any
    """An array, or a mapping or tuple of arrays."""
    facts: Mapping[str, Any]
    """Values that its set-up returned, by source."""
    initial: str
    """Hash of its initial state."""
    disturbance: str
    """Hash of the disturbances that its set-up made."""
    step: Callable[[HostArray, int], tuple[Any, float, bool, bool, Mapping[str, Any]]]
    """Takes an action and the step; returns observation, reward, terminated, truncated, info."""
    view: Callable[[], Any]
    """Returns the argument of `trace` and `render`: the environment, or the state."""
    close: Callable[[], None] = lambda: None
    """Frees its resources."""


@dataclass(frozen=True)
class Measure:
    """A metric, and the function that computes it from an episode."""

    metric: Metric
    of: Callable[[Episode], float]


Show = Callable[[Any], Any]
"""Returns numbers, in metres, that picture a scene."""


@dataclass
class _Batch:
    """State of a batch."""

    worlds: Sequence[SceneInstance]
    observations: list[Any]
    """Latest observation of each world."""
    sensed: dict[str, HostArray]
    running: HostArray
    succeeded: HostArray
    crashed: HostArray
    steps: HostArray
    """Steps made by each scene."""
    metrics: dict[str, HostArray]
    log: dict[str, list[HostArray]]
    rewards: list[HostArray]
    positions: HostArray | None
    """Position of each scene's vehicle, `[B, 3]`, m."""


class EpisodePlant(Plant):
    """A plant whose scenes end independently of each other.

    A scene that has ended is frozen: it moves no further and its sources keep their final values.
    It is a success if `succeeded` returns true for its episode; else a crash if the environment
    ended it, and a timeout if it reached the time limit.

    `trace` returns the position of a scene's vehicle, `(x, y)` or `(x, y, z)` in metres, and
    `render` draws the scene as a line through points `(x, y)`, which the report's player animates.
    Both get the environment, or the state where the plant is made of functions.

    Raises `SystemMistake` for a source that the observation does not hold.
    """

    name = "plant"
    observed: str = "the observation"
    """Name in messages of the object that `observes` takes sources from."""
    identity: str = ""
    """Facts on which trials depend and that are in no file the system imports."""
    code: Sequence[str] = ()
    """Classes, as `module:name`, on whose code trials depend although the system imports none of
    it."""

    def __init__(
        self,
        *,
        observes: Mapping[str, Selector],
        action: str,
        steps: int,
        dt_s: float,
        succeeded: Callable[[Episode], bool],
        metrics: Mapping[str, Measure] | None = None,
        trace: Show | None = None,
        render: Show | None = None,
    ) -> None:
        check_episode(steps, dt_s, succeeded, metrics or {})
        self.dt_s, self.steps, self.metrics = dt_s, steps, dict(metrics or {})
        self._trace, self._render = trace, render
        self.reads = frozenset({Port(action, "actuator")})
        self.action = action
        self._observes, self._succeeded = dict(observes), succeeded
        sample = self.world(f"{SCENE}0", 0)
        self.facts = tuple(sample.facts)
        self.senses = (*self._observes, *self.facts)
        self._real: dict[str, Any] = {}  # types of the sources that begin as real numbers
        sensed = self._sensed([sample], [sample.observation])
        self._real = {name: v.dtype for name, v in sensed.items() if v.dtype.kind == "f"}
        self.shapes = {name: np.shape(value)[1:] for name, value in sensed.items()}
        self._lines([sample])  # else what is wrong with it shows after all trials
        sample.close()

    @abstractmethod
    def world(self, scene: str, seed: int) -> SceneInstance:
        """Return a scene at its start."""

    def _sensed(
        self, worlds: Sequence[SceneInstance], observations: Sequence[Any]
    ) -> dict[str, HostArray]:
        """Return the values of all sources, `[B, ...]`, for these observations."""
        sources = select(self._observes, observations, self.observed)
        for name in self.facts:
            sources[name] = np.array([np.asarray(world.facts[name]) for world in worlds])
        for name, dtype in self._real.items():
            # `max(0, speed)` is a whole number in some scenes, and real where others stand beside.
            if sources[name].dtype.kind in "iu":
                sources[name] = sources[name].astype(dtype)
        return sources

    @override
    def start(self, batch: Batch) -> _Batch:
        worlds, n = [self.world(name, batch.seed) for name in batch.scenes], len(batch.scenes)
        for name, world in zip(batch.scenes, worlds, strict=True):
            if set(world.facts) != set(self.facts):
                both = f"{listed(world.facts)}, and that of '{SCENE}0' {listed(self.facts)}"
                raise SystemMistake(f"the set-up of scene '{name}' returned {both}: name the same")
        observations = [world.observation for world in worlds]
        sensed = self._sensed(worlds, observations)
        return _Batch(
            worlds=worlds,
            observations=observations,
            sensed=sensed,
            running=np.ones(n, bool),
            succeeded=np.zeros(n, bool),
            crashed=np.zeros(n, bool),
            steps=np.zeros(n, int),
            metrics={name: np.full(n, np.nan) for name in self.metrics},
            log={name: [value] for name, value in sensed.items()},
            rewards=[],
            positions=self._positions(worlds),
        )

    def _positions(self, worlds: Sequence[SceneInstance]) -> HostArray | None:
        """Return the position of each scene's vehicle, `[B, 3]`, m."""
        if self._trace is None:
            return None
        positions = np.zeros((len(worlds), 3))
        for row, world in zip(positions, worlds, strict=True):
            position = np.ravel(self._trace(world.view()))
            if not 0 < len(position) < 4:
                raise SystemMistake(
                    f"`trace` returned {len(position)} numbers: give x, y and z in metres"
                )
            row[: len(position)] = position
        return positions

    @override
    def position(self, state: _Batch) -> HostArray | None:
        return state.positions

    def drawn(self, state: _Batch) -> HostArray | None:
        """Return each scene as a line through points, `[B, P, 2]`, m, with NaN at gaps; `None`: the
        plant has no `render`."""
        return self._lines(state.worlds)

    def _lines(self, worlds: Sequence[SceneInstance]) -> HostArray | None:
        if self._render is None:
            return None
        drawings = [self._render(world.view()) for world in worlds]
        try:
            lines: HostArray = np.array(drawings, dtype=float)
        except (TypeError, ValueError):
            lines = np.empty(0)
        if lines.shape[2:] != (2,):
            raise mistake_in(
                self._render,
                "`render` must return points (x, y) in metres, as many at each step; it returned "
                f"{shown(drawings[0])}",
            )
        return lines

    @override
    def sense(self, state: _Batch) -> dict[str, HostArray]:
        return state.sensed

    @override
    def advance(self, state: _Batch, inputs: Inputs) -> _Batch:
        """Move running scenes, and evaluate the episodes that end."""
        running = state.running
        action = to_numpy(inputs[Port(self.action, "actuator")])
        rewards, ends = np.zeros(len(running)), np.zeros((2, len(running)), bool)
        info: list[Mapping[str, Any]] = [{} for _ in running]
        for i in map(int, np.flatnonzero(running)):
            result = state.worlds[i].step(action[i], inputs.step)
            state.observations[i], rewards[i], ends[0, i], ends[1, i], info[i] = result
        sensed = self._sensed(state.worlds, state.observations)
        before, state.sensed, all_run = state.sensed, {}, running.all()
        for name, old in before.items():
            value = sensed[name]
            if not all_run:
                value = np.where(running.reshape(-1, *[1] * (value.ndim - 1)), value, old)
            if value.ndim > 2:
                state.log[name].clear()
            state.log[name].append(value)
            state.sensed[name] = value
        state.rewards.append(rewards)
        state.steps = state.steps + running
        terminated, truncated = ends
        ended = running & (terminated | truncated | (state.steps == self.steps))
        state.positions = self._positions(state.worlds)
        if ended.any():
            self._end(state, ended, terminated, info)
        return state

    def _end(
        self,
        state: _Batch,
        ended: HostArray,
        terminated: HostArray,
        info: Sequence[Mapping[str, Any]],
    ) -> None:
        """Evaluate the episodes that ended at a step."""
        succeeded, crashed = state.succeeded.copy(), state.crashed.copy()
        for i in map(int, np.flatnonzero(ended)):
            signals = {name: np.stack([rows[i] for rows in log]) for name, log in state.log.items()}
            rewards = np.array([row[i] for row in state.rewards])
            episode = Episode(signals, rewards, bool(terminated[i]), info[i], self.dt_s)
            success = self._succeeded(episode)
            succeeded[i] = boolean_of("succeeded", self._succeeded, success, "an episode")
            for name, measure in self.metrics.items():
                state.metrics[name][i] = number_of(name, measure.of, measure.of(episode))
            crashed[i] = terminated[i] and not succeeded[i]
        state.running, state.succeeded, state.crashed = state.running & ~ended, succeeded, crashed
        if not state.running.any():
            for world in state.worlds:
                world.close()

    @override
    def progress(self, state: _Batch) -> Progress:
        time_s = state.steps * self.dt_s
        return Progress(state.running, state.succeeded, state.crashed, time_s, state.metrics)

    @override
    def conditions(self, state: _Batch) -> tuple[Sequence[str], Sequence[str]]:
        return [w.initial for w in state.worlds], [w.disturbance for w in state.worlds]
