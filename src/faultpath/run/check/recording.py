"""Recordings of a treatment's taps and plant while it runs, and the named signals in them.

Nothing that runs knows of it: an observer sees what taps deliver, and the plant of a loop senses
what it senses. Signals are small arrays of numbers: what a source held, what a reader got where
a fault changed it, by how much, and when a fault was in force.
"""

import copy
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pkgutil import resolve_name
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from faultpath.core.arrays import is_array, to_numpy
from faultpath.core.error_source import described
from faultpath.core.errors import SystemMistake
from faultpath.interface import Provenance
from faultpath.loop import DeliveryListener, Loop, Query, Reading, Tap
from faultpath.run.attempt import Done
from faultpath.run.store.signals import DRAWN, IN_FORCE, TOGETHER, Signal
from faultpath.system.composed import ComposedSystem
from faultpath.system.episodes import EpisodePlant
from faultpath.system.loop_system import LoopSystem
from faultpath.system.system import System, TrialReadings

Values: TypeAlias = NDArray[np.float64]
Steps: TypeAlias = dict[int, Values]
"""By control step, `[B, P]`."""

_MOST_NUMBERS = 9
"""Largest size of a signal, that of a rotation matrix; images and candidates are no signals."""


class Recording(DeliveryListener):
    """The numbers that passed the taps of a run, and what can be made of them."""

    def __init__(self) -> None:
        self.sources: dict[str, Steps] = {}
        """By source, or by `plant.truth` for what the plant shows to estimators alone."""
        self.got: dict[tuple[str, str], Steps] = {}
        """By channel and reader."""
        self.clean: dict[tuple[str, str], Steps] = {}
        """Numbers that the source had held, where they were delivered."""
        self.force: dict[int, Any] = {}
        """Scenes in which a fault was in force at some tap."""
        self.queries: dict[str, dict[int, Query]] = {}
        """By source: what could be asked at a step."""
        self.requests: dict[str, Any] = {}
        """By source: the first thing that was asked of it."""

    @override
    def delivered(self, tap: Tap, reading: Reading, step: int, got: Any) -> None:
        if isinstance(reading.value, Query):
            self.queries.setdefault(reading.source, {})[reading.step] = reading.value
            return
        self.source(reading.source, reading.value, reading.step)
        clean, received = _numbers(reading.value), _numbers(got)
        if clean is not None and received is not None:
            at = tap.channel, tap.reader
            self.clean.setdefault(at, {})[step] = clean
            self.got.setdefault(at, {})[step] = received

    @override
    def answered(
        self, tap: Tap, query: Query, step: int, request: Any, answer: Any, got: Any
    ) -> None:
        self.requests.setdefault(tap.source, request)

    @override
    def faulted(self, step: int, in_force: Any) -> None:
        mask = np.array(to_numpy(in_force) if is_array(in_force) else in_force)
        self.force[step] = self.force.get(step, False) | mask

    def source(self, name: str, value: Any, step: int) -> None:
        """Note what a source holds at a step, or its parts, where that is a few numbers."""
        if isinstance(value, Mapping):
            for key, part in cast("Mapping[str, Any]", value).items():
                self.source(f"{name}.{key}", part, step)
            return
        by_step = self.sources.setdefault(name, {})
        if step >= 0 and step not in by_step and (numbers := _numbers(value)) is not None:
            by_step[step] = numbers


def _numbers(value: Any) -> Values | None:
    if not is_array(value) or math.prod(value.shape[1:]) > _MOST_NUMBERS:
        return None
    host = np.array(to_numpy(value))
    if host.dtype.kind not in "fiub":
        return None
    return host.reshape(len(host), -1).astype(np.float64, copy=False)


@dataclass(frozen=True)
class RecordedTrial(TrialReadings):
    """One scene of a recording, while its trial ran."""

    recording: Recording
    scene: int
    steps: int

    @override
    def source(self, name: str) -> Values:
        return self.rows(self.recording.sources[name])

    @override
    def delivered(self, channel: str, reader: str) -> Values:
        return self.rows(self.recording.got[channel, reader])

    def rows(self, by_step: Mapping[int, Values]) -> Values:
        """Return the scene's numbers by step, `[T, P]`, not a number where nothing was noted."""
        values = np.full((self.steps, next(iter(by_step.values())).shape[1]), np.nan)
        for step, rows in by_step.items():
            if step < self.steps:
                values[step] = rows[self.scene]
        return values


def trials(recording: Recording, done: Done, dt_s: float) -> list[RecordedTrial]:
    """Return each trial of a recorded run."""
    steps = (outcome.steps(dt_s) for outcome in done.outcomes)
    return [RecordedTrial(recording, scene, count) for scene, count in enumerate(steps)]


def signals(system: System, recording: Recording, done: Done) -> list[tuple[Signal, ...]]:
    """Return the signals of each scene, with those that the system adds.

    Beside its own there are, for a system that names two `errors`, these and their sum, unless the
    variant has not got what they are taken from; `SystemMistake` where they cannot be computed.
    """
    interface = system.interface
    topics = {name: channel.name for channel in interface.channels for name in channel.sources}
    units = {source.name: source.unit for source in interface.sources}
    fed = {channel.name: channel.sources[0] for channel in interface.channels}
    parts = system.components if isinstance(system, ComposedSystem) else {}
    fixed = {s.name for s in interface.sources if s.provenance is Provenance.CONSTANT}
    series: list[tuple[str, str, str, tuple[str, ...], Mapping[int, Values]]] = []
    for name, by_step in recording.sources.items():
        if name in fixed:
            continue
        part = name.partition(".")[2]  # of a truth, which may be that of a channel
        topic = part if part in fed else topics.get(name, name)
        like = name if name in units else fed.get(part, "")
        series.append((name, topic, units.get(like, ""), parts.get(like, ()), by_step))
    for (channel, reader), got in recording.got.items():
        clean = recording.clean[channel, reader]
        if all(np.array_equal(got[step], clean[step], equal_nan=True) for step in got):
            continue
        unit, named_parts = units[fed[channel]], parts.get(fed[channel], ())
        error = {step: got[step] - clean[step] for step in got}
        series.append((f"{channel} at {reader}", channel, unit, named_parts, got))
        wrong = f"{channel} error"
        series.append((f"{wrong} at {reader}", wrong, unit, named_parts, error))
    if recording.force:
        many = len(done.outcomes)
        force = {
            step: np.broadcast_to(mask, many)[:, None].astype(np.float64)
            for step, mask in recording.force.items()
        }
        series.append((IN_FORCE, IN_FORCE, "1", (), force))
    every = trials(recording, done, system.control_dt_s)
    if system.more_signals:
        more: list[tuple[Signal, ...]] = resolve_name(system.more_signals)(system, recording, done)
    else:
        more = [_error_signals(system, trial) for trial in every]
    return [
        tuple(
            Signal(
                name,
                topic,
                unit,
                values := trial.rows(by_step).astype(np.float32),
                named_parts if len(named_parts) == values.shape[1] else (),
            )
            for name, topic, unit, named_parts, by_step in series
            if by_step
        )
        + beside
        for trial, beside in zip(every, more, strict=True)
    ]


def _error_signals(system: System, trial: RecordedTrial) -> tuple[Signal, ...]:
    errors = system.errors
    if errors is None:
        return ()
    try:
        return added(errors.words, errors.unit, {t.words: t.of(trial) for t in errors.terms})
    except KeyError:
        return ()
    except Exception as error:
        raise SystemMistake(
            f"system '{system.name}': its `errors` cannot be computed ({described(error)})"
        ) from error


def added(topic: str, unit: str, terms: Mapping[str, Values]) -> tuple[Signal, ...]:
    """Return two errors and their sum as signals of one topic."""
    together = np.sum([np.asarray(values, np.float64) for values in terms.values()], axis=0)
    return tuple(
        Signal(name, topic, unit, np.asarray(values, np.float32).reshape(len(together), 1))
        for name, values in {**terms, TOGETHER: together}.items()
    )


def with_plant(system: System, recording: Recording) -> System:
    """Return a system whose plant, where it has one, is recorded too."""
    if not isinstance(system, LoopSystem):
        return system
    inner = system.loop

    def recorded(variant: str, seed: int | None) -> Loop:
        loop = inner(variant, seed)
        plant = copy.copy(loop.graph.plant)
        sense, steps = plant.sense, iter(range(plant.steps + 1))

        def sensed(state: Any) -> Mapping[str, Any]:
            outputs, step = sense(state), next(steps)
            drawn = plant.drawn(state) if isinstance(plant, EpisodePlant) else None
            if drawn is not None:
                recording.sources.setdefault(DRAWN, {})[step] = drawn.reshape(len(drawn), -1)
            for name, value in outputs.items():
                # What a plant shows to estimators alone is named after the plant.
                shown = plant.name if isinstance(value, Mapping) else name
                if not isinstance(value, Query):
                    recording.source(shown, value, step)
            return outputs

        vars(plant)["sense"] = sensed
        return replace(loop, graph=replace(loop.graph, plant=plant))

    system = copy.copy(system)
    vars(system)["loop"] = recorded
    return system
