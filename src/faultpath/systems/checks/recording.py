"""Running an arm once more and recording, as named signals, what its taps and its plant say.

Nothing that runs knows of it: an observer sees what taps deliver, and the plant of a loop senses
what it senses. Recorded are small arrays of numbers: what a source held, what a consumer got where
a fault changed it, by how much, and when a fault was in force.
"""

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from faultpath.core.arrays import is_array, to_numpy
from faultpath.core.error_source import described
from faultpath.core.errors import SystemMistake
from faultpath.interface import Interface, Provenance
from faultpath.loop import Loop, Observer, Query, Reading, Tap
from faultpath.trials import Arm, LoopSystem, Outcome, System
from faultpath.trials.attempt import Done, Raised, Wrong, attempt
from faultpath.trials.execution.worker import Job, building
from faultpath.trials.registry import named
from faultpath.trials.store.signals import IN_FORCE, TOGETHER, Signal
from faultpath.trials.terms import Recorded

Values: TypeAlias = NDArray[np.float64]
Steps: TypeAlias = dict[int, Values]
"""By control step, `[B, P]`."""

_MOST_NUMBERS = 9
"""Of a scene's reading, a rotation matrix; images and candidates are no signals."""


@dataclass
class Recording(Observer):
    """What a run said."""

    interface: Interface
    sources: dict[str, Steps] = field(default_factory=dict[str, Steps])
    """By source, or by `plant.truth` for what the plant shows to estimators alone."""
    got: dict[tuple[str, str], Steps] = field(default_factory=dict[tuple[str, str], Steps])
    """By channel and consumer."""
    given: dict[tuple[str, str], Steps] = field(default_factory=dict[tuple[str, str], Steps])
    """What the source had held, where it was delivered."""
    force: dict[int, Any] = field(default_factory=dict[int, Any])
    """Scenes in which a fault was in force at some tap."""
    queries: dict[str, dict[int, Query]] = field(default_factory=dict[str, dict[int, Query]])
    """By source: what could be asked at a step."""
    asked: dict[str, Any] = field(default_factory=dict[str, Any])
    """By source: the first thing that was asked of it."""

    @override
    def delivered(self, tap: Tap, reading: Reading, step: int, got: Any) -> None:
        if isinstance(reading.value, Query):
            self.queries.setdefault(reading.source, {})[reading.step] = reading.value
            return
        self.source(reading.source, reading.value, reading.step)
        given, had = _numbers(reading.value), _numbers(got)
        if given is not None and had is not None:
            self.given.setdefault((tap.channel, tap.consumer), {})[step] = given
            self.got.setdefault((tap.channel, tap.consumer), {})[step] = had

    @override
    def answered(
        self, tap: Tap, query: Query, step: int, request: Any, answer: Any, got: Any
    ) -> None:
        self.asked.setdefault(tap.source, request)

    @override
    def faulted(self, step: int, held: Any) -> None:
        mask = np.array(to_numpy(held) if is_array(held) else held)
        self.force[step] = self.force.get(step, False) | mask

    def source(self, name: str, value: Any, step: int) -> None:
        """Note what a source holds at a step, or its parts, where that is a few numbers."""
        if isinstance(value, Mapping):
            for part, each in cast("Mapping[str, Any]", value).items():
                self.source(f"{name}.{part}", each, step)
            return
        held = self.sources.setdefault(name, {})
        if step >= 0 and step not in held and (numbers := _numbers(value)) is not None:
            held[step] = numbers


@dataclass(frozen=True)
class Block:
    """An arm over some scenes, to be recorded."""

    arm: Arm
    scenes: tuple[str, ...]


@dataclass(frozen=True)
class RecordedBlock:
    """What came of it, by scene."""

    outcomes: tuple[Outcome, ...] = ()
    signals: tuple[tuple[Signal, ...], ...] = ()
    error: str = ""
    """What kept it from its end."""


def record(job: Job, block: Block) -> RecordedBlock:
    """Run in a worker process, which keeps what it has built for the next block."""
    with building(job) as built:
        return record_here(built.system, block)


def record_here(system: System, block: Block) -> RecordedBlock:
    """Run with a system that is built."""
    done, recording = run_recorded(system, block.arm, block.scenes)
    if not isinstance(done, Done):
        return RecordedBlock(error=str(done.error))
    more = named(system.more_signals) if system.more_signals else error_signals
    beside: list[tuple[Signal, ...]] = more(system, recording, done)
    pairs = zip(signals(recording, done, system.control_dt_s), beside, strict=True)
    return RecordedBlock(done.outcomes, tuple(a + b for a, b in pairs))


def run_recorded(
    system: System, arm: Arm, scenes: Sequence[str]
) -> tuple[Done | Raised | Wrong, Recording]:
    """Run an arm over some scenes and record it; an error comes back as a value."""
    recording = Recording(system.interface)
    if not isinstance(system, LoopSystem):
        return attempt(system, arm, scenes, observer=recording), recording
    inner = system.loop

    def recorded(variant: str, seed: int | None) -> Loop:
        loop = inner(variant, seed)
        plant = copy.copy(loop.graph.plant)
        sense, step = plant.sense, iter(range(plant.steps + 1))

        def sensed(state: Any) -> Mapping[str, Any]:
            outputs, now = sense(state), next(step)
            for name, value in outputs.items():
                # What a plant shows to estimators alone is named after the plant.
                shown = plant.name if isinstance(value, Mapping) else name
                if not isinstance(value, Query):
                    recording.source(shown, value, now)
            return outputs

        vars(plant)["sense"] = sensed
        return replace(loop, graph=replace(loop.graph, plant=plant))

    system = copy.copy(system)
    vars(system)["loop"] = recorded
    return attempt(system, arm, scenes, observer=recording), recording


def signals(recording: Recording, done: Done, dt_s: float) -> list[tuple[Signal, ...]]:
    """Return the signals of each scene, while its trial ran."""
    interface = recording.interface
    topics = {name: channel.name for channel in interface.channels for name in channel.sources}
    units = {source.name: source.unit for source in interface.sources}
    fed = {channel.name: channel.sources[0] for channel in interface.channels}
    fixed = {s.name for s in interface.sources if s.provenance is Provenance.CONSTANT}
    found: list[tuple[str, str, str, Mapping[int, Values]]] = []
    for name, held in recording.sources.items():
        if name in fixed:
            continue
        part = name.partition(".")[2]  # of a truth, which may be that of a channel
        topic = part if part in fed else topics.get(name, name)
        found.append((name, topic, units.get(name, units.get(fed.get(part, ""), "")), held))
    for (channel, consumer), got in recording.got.items():
        given = recording.given[channel, consumer]
        if all(np.array_equal(got[step], given[step], equal_nan=True) for step in got):
            continue
        unit = units[fed[channel]]
        error = {step: got[step] - given[step] for step in got}
        found.append((f"{channel} at {consumer}", channel, unit, got))
        found.append((f"{channel} error at {consumer}", f"{channel} error", unit, error))
    if recording.force:
        many = len(done.outcomes)
        force = {
            step: np.broadcast_to(mask, many)[:, None].astype(np.float64)
            for step, mask in recording.force.items()
        }
        found.append((IN_FORCE, IN_FORCE, "1", force))
    return [
        tuple(
            Signal(name, topic, unit, laid_out(held, at, steps).astype(np.float32))
            for name, topic, unit, held in found
            if held
        )
        for at, steps in enumerate(steps_of(done, dt_s))
    ]


def error_signals(system: System, recording: Recording, done: Done) -> list[tuple[Signal, ...]]:
    """Return the two errors that a system names and their sum, of each scene.

    None where the variant has not got what they are taken from.
    """
    errors = system.errors
    found: list[tuple[Signal, ...]] = []
    for scene, steps in enumerate(steps_of(done, system.control_dt_s)):
        trial = _Trial(recording, scene, steps)
        try:
            terms = {term.words: term.of(trial) for term in errors.terms} if errors else {}
            found.append(added(errors.words, errors.unit, terms) if errors else ())
        except KeyError:
            found.append(())
        except Exception as error:
            raise SystemMistake(
                f"system '{system.name}': its `errors` cannot be computed ({described(error)})"
            ) from error
    return found


def added(topic: str, unit: str, terms: Mapping[str, Values]) -> tuple[Signal, ...]:
    """Return two errors and their sum as signals of one topic."""
    together = np.sum([np.asarray(each, np.float64) for each in terms.values()], axis=0)
    return tuple(
        Signal(name, topic, unit, np.asarray(values, np.float32).reshape(len(together), 1))
        for name, values in {**terms, TOGETHER: together}.items()
    )


@dataclass(frozen=True)
class _Trial(Recorded):
    """One scene of what was recorded."""

    recording: Recording
    scene: int
    steps: int

    @override
    def held(self, source: str) -> Values:
        return laid_out(self.recording.sources[source], self.scene, self.steps)

    @override
    def got(self, channel: str, consumer: str) -> Values:
        return laid_out(self.recording.got[channel, consumer], self.scene, self.steps)


def steps_of(done: Done, dt_s: float) -> list[int]:
    """Return how many control steps each trial took."""
    return [math.ceil(outcome.time_s / dt_s - 1e-6) for outcome in done.outcomes]


def laid_out(held: Mapping[int, Values], scene: int, steps: int) -> Values:
    """Return a scene's numbers by step, `[T, P]`, not a number where nothing was noted."""
    parts = next(iter(held.values())).shape[1]
    values = np.full((steps, parts), np.nan)
    for step, rows in held.items():
        if step < steps:
            values[step] = rows[scene]
    return values


def _numbers(value: Any) -> Values | None:
    if not is_array(value) or math.prod(value.shape[1:]) > _MOST_NUMBERS:
        return None
    host = np.array(to_numpy(value))
    return host.reshape(len(host), -1).astype(np.float64) if host.dtype.kind in "fiub" else None
