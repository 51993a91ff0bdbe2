"""Flying an arm once more and taking down, as named signals, what its taps and its plant say.

Nothing that flies knows of it: taps that listen deliver what taps deliver, and the plant of a loop
senses what it senses. Heard are small arrays of numbers: what a source held, what a consumer got
where a fault changed it, by how much, and when a fault was in force.
"""

import copy
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, TypeAlias, TypeVar, cast

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from faultpath.arrays import is_array, to_numpy
from faultpath.execution.attempt import Done, Raised, Wrong, attempt
from faultpath.interface import Interface, Provenance
from faultpath.loop import Loop
from faultpath.review.components import Components, components_of
from faultpath.store.signals import IN_FORCE, Signal
from faultpath.taps import Query, Reading, Taps
from faultpath.taps.tally import Tally
from faultpath.trials import Arm, LoopSystem, System

Values: TypeAlias = NDArray[np.float64]
_Thing = TypeVar("_Thing")

_MOST_NUMBERS = 9
"""Of a scene's reading, a rotation matrix; images and candidates are no signals."""


@dataclass
class Heard:
    """What was said in a flight, by control step, `[B, P]` each."""

    interface: Interface
    components: Components = field(default_factory=dict[str, Sequence[str]])
    sources: dict[str, dict[int, Values]] = field(default_factory=dict[str, dict[int, Values]])
    """By source, or by `plant.truth` for what the plant shows to estimators alone."""
    got: dict[tuple[str, str], dict[int, Values]] = field(
        default_factory=dict[tuple[str, str], dict[int, Values]]
    )
    """By channel and consumer."""
    given: dict[tuple[str, str], dict[int, Values]] = field(
        default_factory=dict[tuple[str, str], dict[int, Values]]
    )
    """What the source had held, where it was delivered."""
    force: dict[int, NDArray[np.bool_]] = field(default_factory=dict[int, NDArray[np.bool_]])
    """Scenes in which a fault was in force at some tap."""
    queries: dict[str, dict[int, Query]] = field(default_factory=dict[str, dict[int, Query]])
    """By source: what could be asked at a step."""
    asked: dict[str, Any] = field(default_factory=dict[str, Any])
    """By source: the first thing that was asked of it."""

    def source(self, name: str, value: Any, step: int) -> None:
        """Note what a source holds at a step, where that is a few numbers."""
        held = self.sources.setdefault(name, {})
        if step >= 0 and step not in held and (numbers := _numbers(value)) is not None:
            held[step] = numbers

    def sensed(self, plant: str, outputs: Mapping[str, Any], step: int) -> None:
        """Note what a plant senses, and the parts of what it shows."""
        for name, value in outputs.items():
            if isinstance(value, Mapping):
                for part, each in cast("Mapping[str, Any]", value).items():
                    self.source(f"{plant}.{part}", each, step)
            elif not isinstance(value, Query):
                self.source(name, value, step)

    def delivered(self, channel: str, consumer: str, reading: Reading, got: Any, step: int) -> None:
        """Note what passed a tap."""
        self.source(reading.source, reading.value, reading.step)
        given, had = _numbers(reading.value), _numbers(got)
        if given is not None and had is not None:
            self.given.setdefault((channel, consumer), {})[step] = given
            self.got.setdefault((channel, consumer), {})[step] = had


class HearingTaps(Taps):
    """Taps that note what passes; what is delivered is the same to the bit."""

    def __init__(self, *given: Any, heard: Heard, **named: Any) -> None:
        super().__init__(*given, **named)
        self._heard = heard
        self._struck = _Noted(heard.force, len(self._scenes))

    @override
    def deliver(self, channel: str, consumer: str, reading: Reading, step: int) -> Any:
        got = super().deliver(channel, consumer, reading, step)
        if isinstance(reading.value, Query):
            self._heard.queries.setdefault(reading.source, {})[reading.step] = reading.value
        else:
            self._heard.delivered(channel, consumer, reading, got, step)
        return got

    @override
    def _answer(self, tap: Any, query: Query, step: int, request: Any) -> Any:
        self._heard.asked.setdefault(tap.source, request)
        return super()._answer(tap, query, step, request)


class _Noted(Tally):
    """A tally that keeps the scenes of each step."""

    def __init__(self, force: dict[int, NDArray[np.bool_]], scenes: int) -> None:
        super().__init__()
        self._force, self._scenes = force, scenes

    @override
    def note(self, step: int, held: Any) -> None:
        super().note(step, held)
        mask = np.broadcast_to(np.array(to_numpy(held) if is_array(held) else held), self._scenes)
        self._force[step] = self._force.get(step, False) | mask


def fly_heard(
    system: System, arm: Arm, scenes: Sequence[str]
) -> tuple[Done | Raised | Wrong, Heard]:
    """Run an arm over some scenes and listen; an error comes back as a value."""
    heard = Heard(system.interface, components_of(system))
    listened = system
    if isinstance(system, LoopSystem):
        loop = system.loop

        def listening(variant: str, seed: int | None) -> Loop:
            return _listening(loop(variant, seed), heard)

        listened = _with(system, "loop", listening)
    return attempt(listened, arm, scenes, kind=partial(HearingTaps, heard=heard)), heard


def signals(heard: Heard, done: Done, dt_s: float) -> list[tuple[Signal, ...]]:
    """Return the signals of each scene, while its trial ran."""
    topics = {
        name: channel.name for channel in heard.interface.channels for name in channel.sources
    }
    units = {source.name: source.unit for source in heard.interface.sources}
    channels = {channel.name for channel in heard.interface.channels}
    named = {
        channel.name: heard.components[source]
        for channel in heard.interface.channels
        for source in reversed(channel.sources)
        if source in heard.components
    }
    found: list[tuple[str, str, str, Mapping[int, Values]]] = []
    fixed = {s.name for s in heard.interface.sources if s.provenance is Provenance.CONSTANT}
    for name, held in heard.sources.items():
        if name in fixed:
            continue
        part = name.partition(".")[2]
        same = next((s for s, c in topics.items() if c == part), "")
        topic = part if part in channels else topics.get(name, name)
        found.append((name, topic, units.get(name, units.get(same, "")), held))
    for (channel, consumer), got in heard.got.items():
        given = heard.given[channel, consumer]
        if all(np.array_equal(got[step], given[step], equal_nan=True) for step in got):
            continue
        unit = units[heard.interface.channel(channel).sources[0]]
        error = {step: got[step] - given[step] for step in got}
        found.append((f"{channel} at {consumer}", channel, unit, got))
        found.append((f"{channel} error at {consumer}", f"{channel} error", unit, error))
    if heard.force:
        force = {step: mask[:, None].astype(np.float64) for step, mask in heard.force.items()}
        found.append((IN_FORCE, IN_FORCE, "1", force))

    def parts(name: str, topic: str) -> tuple[str, ...]:
        return tuple(heard.components.get(name) or named.get(topic.removesuffix(" error"), ()))

    return [
        tuple(
            Signal(
                name, topic, unit, laid_out(held, at, steps).astype(np.float32), parts(name, topic)
            )
            for name, topic, unit, held in found
            if held
        )
        for at, steps in enumerate(steps_of(done, dt_s))
    ]


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


def _listening(loop: Loop, heard: Heard) -> Loop:
    plant = loop.graph.plant
    sense, step = plant.sense, iter(range(plant.steps + 1))

    def heard_too(state: Any) -> Mapping[str, Any]:
        outputs = sense(state)
        heard.sensed(plant.name, outputs, next(step))
        return outputs

    return replace(loop, graph=replace(loop.graph, plant=_with(plant, "sense", heard_too)))


def _with(thing: _Thing, name: str, method: Callable[..., Any]) -> _Thing:
    other = copy.copy(thing)
    vars(other)[name] = method
    return other
