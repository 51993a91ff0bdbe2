"""The one loop: modules in graph order, every edge a tap, every source in its own time."""

import math
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

from faultpath.core.arrays import Array
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

_SLACK = 1e-6
"""Share of a step that rounding of rates and latencies may take away."""


class Clock:
    """Turns what a source holds at every step into what has arrived of it.

    A source of `rate_hz` is sampled at the first control step at or after each of its ticks, and
    held in between. Its sample arrives `latency_s` later, rounded up to whole steps; until one has
    arrived, the first sample is delivered. A reading says of which step it is.
    """

    def __init__(self, source: Source, dt_s: float) -> None:
        self._name = source.name
        ticks = (source.rate_hz or math.inf) * dt_s
        self._ticks = None if ticks >= 1 - _SLACK else ticks
        self._late = math.ceil(source.latency_s / dt_s - _SLACK)
        self._turn = -1
        self._under_way: deque[Reading] = deque()

    def read(self, value: Any, step: int) -> Reading:
        """Return the reading that has arrived at `step`, whose value at the source is `value`."""
        turn = step if self._ticks is None else math.floor(step * self._ticks + _SLACK)
        if turn != self._turn:
            self._turn = turn
            self._under_way.append(Reading(value, self._name, step))
        waiting = self._under_way
        while len(waiting) > 1 and waiting[1].step + self._late <= step:
            waiting.popleft()
        return waiting[0]


class Deliverer(Protocol):
    """Methods of taps that a loop calls, for classes that stand between the two."""

    def deliver(self, channel: str, reader: str, reading: Reading, step: int) -> Any:
        """Return what a reader gets of a reading; see `Taps.deliver`."""
        ...

    def set_active(self, mask: Array | None) -> None:
        """Say which scenes still run, bool `[B]`."""
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
        """Start a batch, and yield each of its control steps and the one at which nothing runs.

        The last instant's `inputs` are empty: nothing reaches the plant any more.
        """
        return _Execution(self, batch, taps).run()


class _Execution:
    """One execution: what the sources hold, now and one step before."""

    def __init__(self, loop: Loop, batch: Batch, taps: Deliverer) -> None:
        self._graph = graph = loop.graph
        self._taps = taps
        read = {graph.bindings[port.channel] for part in graph.parts for port in part.ports}
        self._clocks = {name: Clock(loop.interface.source(name), batch.dt_s) for name in read}
        """Clocks of the sources that somebody reads."""
        self._ports = {id(part): tuple(_ports_of(part, graph)) for part in graph.parts}
        self._past: dict[str, Reading] = {}
        self._state = graph.plant.start(batch)
        self._memories = [module.begin(batch) for module in graph.modules]
        self._now = {
            name: Reading(value, name, -1)
            for module in graph.modules
            for name, value in module.before(batch).items()
            if name in module.writes and name in read
        }

    def run(self) -> Iterator[Instant]:
        plant, modules, memories = self._graph.plant, self._graph.modules, self._memories
        state, step = self._state, 0
        told_apart = type(plant).over is not Plant.over
        while step < plant.steps:
            if told_apart and plant.over(state, step):
                break
            running = plant.progress(state).running
            if not told_apart and not running.any():
                break
            self._taps.set_active(running)
            self._past, self._now = self._now, {}
            sensed = plant.sense(state)
            self._hold(plant, sensed, step, plant.senses)
            truths = {name: _returned(plant, sensed, name, step) for name in plant.shows}
            for index, module in enumerate(modules):
                inputs = self._inputs(module, step, truths, running)
                outputs, memories[index] = module.step(inputs, memories[index])
                self._hold(module, outputs, step, module.writes)
            inputs = self._inputs(plant, step, {}, running)
            yield Instant(step, state, inputs)
            state = plant.advance(state, inputs)
            step += 1
        yield Instant(step, state, Inputs(plant.name, step, {}, {}))

    def _hold(self, part: Part, outputs: Outputs, step: int, names: tuple[str, ...]) -> None:
        """Take in what a part's sources hold at a step, as far as somebody reads them."""
        for name in names:
            if name in self._clocks:
                value = _returned(part, outputs, name, step)
                self._now[name] = self._clocks[name].read(value, step)

    def _inputs(self, part: Part, step: int, truths: Mapping[str, Any], running: Array) -> Inputs:
        delivered: dict[tuple[str, str], Any] = {}
        at_read: dict[Port, Callable[[], Any]] = {}
        for port, reader, source, past, at_read_only in self._ports[id(part)]:
            reading = self._past.get(source) if past else self._now[source]
            if reading is None:
                raise SystemMistake(
                    f"{label_of(part)} reads what channel '{port.channel}' held one step before, "
                    f"but {self._no_past(source)}"
                )
            if at_read_only:
                at_read[port] = partial(self._taps.deliver, port.channel, reader, reading, step)
            else:
                delivered[port] = self._taps.deliver(port.channel, reader, reading, step)
        declared = part.truths if isinstance(part, Module) else ()
        shown = {name: truths[name] for name in declared}
        return Inputs(part.name, step, delivered, shown, running, at_read, label_of(part))

    def _no_past(self, source: str) -> str:
        """Say why nothing is known of a source before the first step, and what to do."""
        if source in self._graph.plant.senses:
            return (
                f"source '{source}' is the plant's: `past=` and reads_past are for sources that a "
                f"module writes; read '{source}' at this step and keep its earlier value in memory"
            )
        return (
            f"nobody says what source '{source}' held before the first step: write "
            f'`@writes("{source}", before=0.0)`, or return it from before() of its module'
        )


def _ports_of(part: Part, graph: Graph) -> Iterator[tuple[Port, str, str, bool, bool]]:
    """Yield each port, its reader and source, whether it reads the past, and only when asked."""
    for port in sorted(part.ports):
        source = graph.bindings[port.channel]
        yield port, part.reader(port), source, port not in part.reads, port in part.at_read


def _returned(part: Part, outputs: Outputs, name: str, step: int) -> Any:
    """Return an entry that a part promised; `SystemMistake` where it did not return it."""
    if name not in outputs:
        verb = "writes source"
        if isinstance(part, Plant):
            verb = "shows the truth" if name in part.shows else "senses source"
        raise SystemMistake(
            f"{label_of(part)} {verb} '{name}', but at step {step} it returned no such entry; it "
            f"returned: {listed(outputs)}"
        )
    return outputs[name]
