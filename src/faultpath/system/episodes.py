"""A plant of episodes: each scene runs until it ends, and stays as it ended."""

from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from typing_extensions import override

from faultpath.core.arrays import HostArray, to_numpy
from faultpath.core.errors import SystemMistake
from faultpath.core.text import unknown
from faultpath.loop import Batch, Inputs, Plant, Port, Progress
from faultpath.system.arguments import check_episode, truth_of
from faultpath.system.observed import Look, look
from faultpath.system.outcome import Metric

SCENE = "seed/"
"""A scene is called after the seed of its reset, `seed/7`."""


@dataclass(frozen=True)
class Episode:
    """One finished trial, as rules on success see it.

    `episode["angle"]` is what the source `angle` held: at the start and after each step,
    `[T + 1, ...]`. Of a source with more than one axis, such as an image, only the last is kept,
    `[1, ...]`.
    """

    signals: Mapping[str, HostArray]
    rewards: HostArray
    """`[T]`; zeros where there are none."""
    terminated: bool
    """Whether the environment ended it, for good or bad; else its time was up."""
    info: Mapping[str, Any]
    """Info that the environment returned at its last step."""
    dt_s: float

    def __getitem__(self, source: str) -> HostArray:
        """Return what a source held; `SystemMistake` for an unknown one."""
        if source not in self.signals:
            raise SystemMistake(f"an episode: {unknown('source', source, self.signals)}")
        return self.signals[source]

    @property
    def returned(self) -> float:
        """The sum of its rewards."""
        return float(self.rewards.sum())


@dataclass(frozen=True)
class SceneInstance:
    """One scene at its start; made for one trial and thrown away with it."""

    observation: Any
    """An array, or a mapping or tuple of such."""
    facts: Mapping[str, Any]
    """Values that its set-up returned, by source."""
    initial: str
    """A hash of its initial state."""
    disturbance: str
    """A hash of what its set-up did."""
    step: Callable[[HostArray, int], tuple[Any, float, bool, bool, Mapping[str, Any]]]
    """Moves it by an action at a step; returns observation, reward, terminated, truncated, info."""
    seen: Callable[[], Any]
    """Returns what `trace` and `render` look at: the environment, or the state."""
    close: Callable[[], None] = lambda: None
    """Frees what it holds."""


@dataclass(frozen=True)
class Measure:
    """A metric of a system of episodes, and how it is taken from one."""

    metric: Metric
    of: Callable[[Episode], float]


Show = Callable[[Any], Any]
"""Returns numbers, in metres, that show a scene."""


@dataclass
class _Batch:
    """A batch under way."""

    worlds: Sequence[SceneInstance]
    seen: list[Any]
    """The last observation of each world."""
    sensed: dict[str, HostArray]
    running: HostArray
    succeeded: HostArray
    crashed: HostArray
    steps: HostArray
    """Steps that each scene has made."""
    metrics: dict[str, HostArray]
    log: dict[str, list[HostArray]]
    rewards: list[HostArray]
    at: HostArray | None
    """Position of each, `[B, 3]`, metres."""


class EpisodePlant(Plant):
    """A plant whose scenes end by themselves, each in its own time.

    A scene that has ended is frozen: it is not moved any more, and what it senses stays what it
    was at its end. It counts as a success where `succeeded` says so of its episode; else as a crash
    where the environment ended it, and as a timeout where its time was up.

    `trace` says where a scene's vehicle is, `(x, y)` or `(x, y, z)` in metres, and `render` draws
    the scene as a line through points `(x, y)`: that is what the report's player moves. Both look
    at the environment, or at the state where the plant is made of functions.

    Raises `SystemMistake` for a source that the observation does not hold.
    """

    name = "plant"
    observed: str = "the observation"
    """Name in messages of where `observes` looks."""
    identity: str = ""
    """Facts that decide a trial and stand in no file that the system imports."""
    code: Sequence[str] = ()
    """Classes, as `module:name`, whose code decides a trial and is not imported."""

    def __init__(
        self,
        *,
        observes: Mapping[str, Look],
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
        probed = self.world(f"{SCENE}0", 0)
        self.facts = tuple(probed.facts)
        self.senses = (*self._observes, *self.facts)
        sensed = self._sensed([probed], [probed.observation])
        self.shapes = {name: np.shape(value)[1:] for name, value in sensed.items()}
        probed.close()

    @abstractmethod
    def world(self, scene: str, seed: int) -> SceneInstance:
        """Return a scene at its start."""

    def _sensed(
        self, worlds: Sequence[SceneInstance], observations: Sequence[Any]
    ) -> dict[str, HostArray]:
        """Return every source, `[B, ...]`, of worlds with these observations."""
        sources = look(self._observes, observations, self.observed)
        for name in self.facts:
            sources[name] = np.array([np.asarray(world.facts[name]) for world in worlds])
        return sources

    @override
    def start(self, batch: Batch) -> _Batch:
        worlds, n = [self.world(name, batch.seed) for name in batch.scenes], len(batch.scenes)
        seen = [world.observation for world in worlds]
        sensed = self._sensed(worlds, seen)
        return _Batch(
            worlds=worlds,
            seen=seen,
            sensed=sensed,
            running=np.ones(n, bool),
            succeeded=np.zeros(n, bool),
            crashed=np.zeros(n, bool),
            steps=np.zeros(n, int),
            metrics={name: np.full(n, np.nan) for name in self.metrics},
            log={name: [value] for name, value in sensed.items()},
            rewards=[],
            at=self._places(worlds),
        )

    def _places(self, worlds: Sequence[SceneInstance]) -> HostArray | None:
        """Return where each world is, `[B, 3]`."""
        if self._trace is None:
            return None
        places = np.zeros((len(worlds), 3))
        for row, world in zip(places, worlds, strict=True):
            at = np.ravel(self._trace(world.seen()))
            if not 0 < len(at) < 4:
                raise SystemMistake(
                    f"`trace` returned {len(at)} numbers: give x, y and z in metres"
                )
            row[: len(at)] = at
        return places

    @override
    def position(self, state: _Batch) -> HostArray | None:
        return state.at

    def drawn(self, state: _Batch) -> HostArray | None:
        """Return each scene as a line through points, `[B, P, 2]`, metres, not a number where the
        pen is lifted; `None`: there is no such picture."""
        if self._render is None:
            return None
        lines = [np.asarray(self._render(world.seen()), float) for world in state.worlds]
        if any(line.ndim != 2 or line.shape != (len(lines[0]), 2) for line in lines):
            raise SystemMistake(
                "`render` must return points (x, y) in metres, as many at each step; it returned "
                f"an array of shape {list(lines[0].shape)}"
            )
        return np.stack(lines)

    @override
    def sense(self, state: _Batch) -> dict[str, HostArray]:
        return state.sensed

    @override
    def advance(self, state: _Batch, inputs: Inputs) -> _Batch:
        """Move what runs, freeze what does not, and judge what ends."""
        running = state.running
        action = to_numpy(inputs[Port(self.action, "actuator")])
        rewards, ends = np.zeros(len(running)), np.zeros((2, len(running)), bool)
        info: list[Mapping[str, Any]] = [{} for _ in running]
        for i in map(int, np.flatnonzero(running)):
            result = state.worlds[i].step(action[i], inputs.step)
            state.seen[i], rewards[i], ends[0, i], ends[1, i], info[i] = result
        fresh = self._sensed(state.worlds, state.seen)
        before, state.sensed, all_run = state.sensed, {}, running.all()
        for name, old in before.items():
            value = fresh[name]
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
        state.at = self._places(state.worlds)
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
        """Judge the episodes that ended at a step."""
        succeeded, crashed = state.succeeded.copy(), state.crashed.copy()
        for i in map(int, np.flatnonzero(ended)):
            signals = {name: np.stack([rows[i] for rows in log]) for name, log in state.log.items()}
            paid = np.array([row[i] for row in state.rewards])
            episode = Episode(signals, paid, bool(terminated[i]), info[i], self.dt_s)
            success = self._succeeded(episode)
            succeeded[i] = truth_of("succeeded", self._succeeded, success, "an episode")
            for name, measure in self.metrics.items():
                state.metrics[name][i] = measure.of(episode)
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
