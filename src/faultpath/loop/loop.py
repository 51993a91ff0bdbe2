"""The one loop: modules in graph order, every edge a tap, every source at its own rate."""

import math
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

from faultpath.core.arrays import Array, copy, is_array
from faultpath.core.errors import SystemMistake
from faultpath.core.text import listed
from faultpath.interface import Interface, Source
from faultpath.loop.parts import (
    Batch,
    Graph,
    Inputs,
    Module,
    Outputs,
    Part,
    Plant,
    Port,
    State,
    label_of,
)
from faultpath.loop.reading import Reading
from faultpath.loop.taps import UNREAD

_SLACK = 1e-6
"""Share of a step by which rates and latencies may miss a whole step, through rounding."""


class SampledSource:
    """Applies a source's rate and latency.

    A source of `rate_hz` is sampled at the first control step at or after each of its ticks, and
    held in between. A sample arrives `latency_s` later, rounded up to whole steps; until the first
    has arrived it is delivered early, since there is nothing else to deliver. A reading holds the
    step at which it was sampled; one that is delivered in later steps is a copy, because its owner
    may write into the value once the step is over.
    """

    def __init__(self, source: Source, dt_s: float, read_past: bool = False) -> None:
        self._name = source.name
        samples_per_step = (source.rate_hz or math.inf) * dt_s
        self._every_step = samples_per_step >= 1 - _SLACK
        self._samples_per_step = samples_per_step
        self._latency_steps = math.ceil(source.latency_s / dt_s - _SLACK)
        self._held = read_past or self._latency_steps > 0 or not self._every_step
        self._sample_index = -1
        self._in_transit: deque[Reading] = deque()
        """The newest sample that has arrived, and those after it that have not."""

    def read(self, value: Any, step: int) -> Reading:
        """Return the newest sample that has arrived at `step`; `value` is the source's own now."""
        sample_index = (
            step if self._every_step else math.floor(step * self._samples_per_step + _SLACK)
        )
        if sample_index != self._sample_index:
            self._sample_index = sample_index
            value = copy(value) if self._held and is_array(value) else value
            self._in_transit.append(Reading(value, self._name, step))
        samples = self._in_transit
        while len(samples) > 1 and samples[1].step + self._latency_steps <= step:
            samples.popleft()
        return samples[0]


class Deliverer(Protocol):
    """Methods of taps that a loop calls, for classes that wrap taps."""

    def deliver(
        self, channel: str, reader: str, reading: Reading, step: int, scene: int | None = None
    ) -> Any:
        """Return the value that a reader gets; see `Taps.deliver`."""
        ...

    def set_active(self, mask: Array | None) -> None:
        """Set which scenes still run, bool `[B]`."""
        ...


@dataclass(frozen=True)
class Instant:
    """A control step before the plant moves on."""

    step: int
    state: State
    inputs: Inputs
    """Readings that reach the plant."""


@dataclass(frozen=True)
class Loop:
    """Executes a graph over batches of scenes."""

    interface: Interface
    """Declares rates and latencies of the sources."""
    graph: Graph
    """Plant and modules to execute; see `faultpath.loop.graph`."""

    def execute(self, batch: Batch, taps: Deliverer) -> Iterator[Instant]:
        """Start a batch and yield each control step, and then the state at which it ended.

        The last instant's `inputs` are empty, because nothing moves the plant any more.
        """
        return _Execution(self, batch, taps).run()


class _Execution:
    """State of one run: current and previous values of the sources."""

    def __init__(self, loop: Loop, batch: Batch, taps: Deliverer) -> None:
        self._graph = graph = loop.graph
        self._taps = taps
        bound, parts = graph.bindings, graph.parts
        read = {bound[port.channel] for part in parts for port in part.ports}
        past = {bound[port.channel] for part in parts for port in part.reads_past}
        self._sources = {
            name: SampledSource(loop.interface.source(name), batch.dt_s, name in past)
            for name in read
        }
        """Only those with a reader."""
        self._ports = {id(part): tuple(_ports_of(part, graph)) for part in graph.parts}
        self._previous: dict[str, Reading] = {}
        self._state = graph.plant.start(batch)
        self._memories = [module.begin(batch) for module in graph.modules]
        self._current = {
            name: Reading(value, name, -1)
            for module in graph.modules
            for name, value in module.before(batch).items()
            if name in module.writes and name in read
        }

    def run(self) -> Iterator[Instant]:
        plant, modules, memories = self._graph.plant, self._graph.modules, self._memories
        state, step = self._state, 0
        while step < plant.steps:
            over = plant.over(state, step)
            running = plant.progress(state).running
            if over or (over is None and not running.any()):
                break
            self._taps.set_active(running)
            self._previous, self._current = self._current, {}
            sensed = plant.sense(state)
            self._sample(plant, sensed, step, plant.senses)
            truths = {name: _output(plant, sensed, name, step) for name in plant.shows}
            for index, module in enumerate(modules):
                inputs = self._inputs(module, step, truths, running)
                outputs, memories[index] = module.step(inputs, memories[index])
                self._sample(module, outputs, step, module.writes)
            inputs = self._inputs(plant, step, {}, running)
            yield Instant(step, state, inputs)
            state = plant.advance(state, inputs)
            step += 1
        yield Instant(step, state, Inputs(plant.name, step, {}, {}))

    def _sample(self, part: Part, outputs: Outputs, step: int, names: tuple[str, ...]) -> None:
        """Sample those of a part's sources that have a reader."""
        for name in names:
            if name in self._sources:
                value = _output(part, outputs, name, step)
                self._current[name] = self._sources[name].read(value, step)

    def _inputs(self, part: Part, step: int, truths: Mapping[str, Any], running: Array) -> Inputs:
        delivered: dict[tuple[str, str], Any] = {}
        at_read: dict[Port, Callable[..., Any]] = {}
        for port, reader, source, past, at_read_only in self._ports[id(part)]:
            reading = self._previous.get(source) if past else self._current[source]
            if reading is None:
                raise SystemMistake(
                    f"{label_of(part)} reads what channel '{port.channel}' held one step before, "
                    f"but {self._no_past(source)}"
                )
            deliver = partial(self._taps.deliver, port.channel, reader, reading, step)
            if at_read_only:
                deliver(UNREAD)
                at_read[port] = deliver
            else:
                delivered[port] = deliver()
        declared = part.truths if isinstance(part, Module) else ()
        shown = {name: truths[name] for name in declared}
        return Inputs(part.name, step, delivered, shown, running, at_read, label_of(part))

    def _no_past(self, source: str) -> str:
        """Return why a source has no value before the first step, and what to do."""
        if source in self._graph.plant.senses:
            return (
                f"source '{source}' is the plant's: `past=` and reads_past are for sources that a "
                f"module writes; read '{source}' at this step and keep its earlier value in memory"
            )
        return (
            f"no value of source '{source}' is known before the first step: write "
            f'`@writes("{source}", before=0.0)`, or return it from before() of its module'
        )


def _ports_of(part: Part, graph: Graph) -> Iterator[tuple[Port, str, str, bool, bool]]:
    """Yield each port, its reader and source, whether it reads the past, and only on access."""
    for port in sorted(part.ports):
        source = graph.bindings[port.channel]
        yield port, part.reader(port), source, port not in part.reads, port in part.at_read


def _output(part: Part, outputs: Outputs, name: str, step: int) -> Any:
    """Return an entry of a part's outputs; `SystemMistake` where it is missing."""
    if name not in outputs:
        verb = "writes source"
        if isinstance(part, Plant):
            verb = "shows the truth" if name in part.shows else "senses source"
        raise SystemMistake(
            f"{label_of(part)} {verb} '{name}', but at step {step} it returned no such entry; it "
            f"returned: {listed(outputs)}"
        )
    return outputs[name]
