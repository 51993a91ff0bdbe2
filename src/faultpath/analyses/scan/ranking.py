"""Which source comes first: number of readers, then how far its error moves the commands.

The probe is that of the paper, Section III-B, applied to the whole controller: `A_s = median |u(s')
- u(s)|`. A loop runs under correct inputs. Beside it, step by step, its modules run again on what
its plant senses and on the commands that it has executed, with the fault in force: histories are
those of the first run, and only what modules make of the faulty input differs, what they carry from
step to step included. The median is over the steps of all scenes while they run, of the distance
between both commands, each component as a fraction of its root mean square in the first run.
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.analyses.model import SHARED
from faultpath.analyses.scan.sources import Candidate
from faultpath.core.arrays import is_array, to_numpy
from faultpath.core.error_source import described
from faultpath.core.errors import Notice
from faultpath.faults import Fault, at_readers
from faultpath.loop import Batch, Inputs, Loop, Plant, Progress, Reading, Taps
from faultpath.run.apart import set_apart
from faultpath.run.attempt import taps_of
from faultpath.run.plan import Treatment
from faultpath.stats.inputs import Floats
from faultpath.system.declared import Variant
from faultpath.system.loop_system import LoopSystem
from faultpath.system.system import System

Key: TypeAlias = tuple[str, str]
"""Name of a treatment, as its caller has it."""
PROBED_SCENES = 5
"""A probe is a look at where to begin, and no result."""


def ranking(
    system: System,
    variants: Sequence[Variant],
    candidates: Sequence[Candidate],
    scenes: Sequence[str],
    seed: int,
) -> tuple[Candidate, ...]:
    """Return the sources ranked, those of a loop system with the response to their errors."""
    responses: dict[str, float] = {}
    if isinstance(system, LoopSystem):
        for variant in variants:
            faults = {
                (candidate.name, reach): parts
                for candidate in candidates
                for reach, parts in _conditions(system, variant, candidate).items()
                if parts
            }
            moved = command_responses(system, variant.name, faults, scenes, seed)
            for (name, _), value in moved.items():
                responses[name] = max(value, responses.get(name, value))
    return ranked([c.model_copy(update={"response": responses.get(c.name)}) for c in candidates])


def _conditions(
    system: System, variant: Variant, candidate: Candidate
) -> dict[str, tuple[Fault, ...]]:
    """Return the error of a source at each module alone and at all of them, in a variant."""
    alone = {
        module: at_readers(at_readers(system.fault(text), variant.readers), (module,))
        for module in candidate.modules
        if (text := candidate.at.get(module, candidate.fault))
    }
    return {**alone, SHARED: tuple(fault for faults in alone.values() for fault in faults)}


def ranked(candidates: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Return candidates, the one with most readers and then the largest probe response first.

    This is the paper's rule, Section III-C. It compares point estimates: sources that are equal in
    both share a rank, and stand in the order of declaration, those without a fault last. A response
    that is not known counts as the smallest.
    """

    def key(candidate: Candidate) -> tuple[int, float]:
        return -len(candidate.readers), 1.0 if candidate.response is None else -candidate.response

    out: list[Candidate] = []
    for _, alike in groupby(
        sorted(candidates, key=lambda candidate: (*key(candidate), not candidate.fault)), key
    ):
        rank = len(out) + 1
        out += [candidate.model_copy(update={"rank": rank}) for candidate in alike]
    return tuple(out)


def command_responses(
    system: LoopSystem,
    variant: str,
    faults: Mapping[Key, Sequence[Fault]],
    scenes: Sequence[str],
    seed: int,
) -> dict[Key, float]:
    """Return the response to each treatment's faults that do not stop the variant's modules.

    Empty where nothing that faultpath sees reaches the plant. Raises what the run raises.
    """
    with set_apart(system):
        loop = system.loop(variant, seed)
        first = _First(system, variant, faults, tuple(scenes), seed, loop)
        taps = _Taps(first, (), records=True)
        system.execute(_with_plant(loop, first), scenes, taps, seed)
    if not first.commands or first.commands[0].shape[1] == 0:
        return {}
    commands, running = np.stack(first.commands), np.stack(first.running)
    size = np.sqrt(np.mean(commands[running] ** 2, axis=0))
    size[size == 0.0] = 1.0
    responses: dict[Key, float] = {}
    for key, moved in first.moved.items():
        apart = (np.stack(moved) - commands)[running] / size
        median = float(np.median(np.sqrt(np.mean(apart**2, axis=1))))
        if np.isfinite(median):
            responses[key] = float(f"{median:.6g}")  # what rounding parts is equal
    return responses


class _First(Plant):
    """The plant of the first run. Before it moves, the modules beside it take the same step."""

    def __init__(
        self,
        system: LoopSystem,
        variant: str,
        faults: Mapping[Key, Sequence[Fault]],
        scenes: tuple[str, ...],
        seed: int,
        loop: Loop,
    ) -> None:
        plant = loop.graph.plant
        self.name, self.steps = plant.name, plant.steps
        self.reads, self.reads_past = plant.reads, plant.reads_past
        self.senses, self.shows = plant.senses, plant.shows
        self.system, self.variant, self.scenes, self.seed = system, variant, scenes, seed
        self.past = {
            (port.channel, part.reader(port))
            for part in loop.graph.parts
            for port in part.reads_past
        }
        """Taps, by channel and reader, at which a port reads what was held one step before."""
        self.readings: dict[tuple[str, str], Reading] = {}
        """Readings of the past, at the present step."""
        self.sensed: Mapping[str, Any] = {}
        self.stands: Progress | None = None
        self.moved: dict[Key, list[Floats]] = {key: [] for key in faults}
        self.commands: list[Floats] = []
        self.running: list[NDArray[np.bool_]] = []
        self._plant, self._faults = plant, faults
        self._others: dict[Key, Any] = {}

    def start(self, batch: Batch) -> Any:
        return self._plant.start(batch)

    def sense(self, state: Any) -> Mapping[str, Any]:
        self.sensed = self._plant.sense(state)
        return self.sensed

    def progress(self, state: Any) -> Progress:
        self.stands = self._plant.progress(state)
        return self.stands

    def advance(self, state: Any, inputs: Inputs) -> Any:
        if not self.commands:
            batch = Batch(self.scenes, self.seed, self.system.control_dt_s)
            for key, faults in self._faults.items():
                loop = self.system.loop(self.variant, self.seed)
                beside = _with_plant(loop, _Beside(loop.graph.plant, self))
                self._others[key] = beside.execute(batch, _Taps(self, faults, records=False))
        assert self.stands is not None
        self.commands.append(self._command(inputs))
        self.running.append(np.array(to_numpy(self.stands.running), dtype=bool))
        for key in list(self._others):
            try:
                self.moved[key].append(self._command(next(self._others[key]).inputs))
            except Exception as error:  # what modules raise that were not made for such an input
                del self._others[key], self.moved[key]
                text = f"{' '.join(map(str, key))}, {self.variant}: no probe response, since its "
                text += f"modules stop at such an input ({described(error)})."
                warnings.warn(Notice(text), stacklevel=1)
        return self._plant.advance(state, inputs)

    def _command(self, inputs: Inputs) -> Floats:
        n = len(self.scenes)
        parts = [
            np.array(to_numpy(inputs[port]), dtype=np.float64).reshape(n, -1)
            for port in inputs
            if is_array(inputs[port])
        ]
        return np.concatenate(parts, axis=1) if parts else np.empty((n, 0))

    def conditions(self, state: Any) -> tuple[Sequence[str], Sequence[str]]:
        return self._plant.conditions(state)

    def over(self, state: Any, step: int) -> bool | None:
        return self._plant.over(state, step)


class _Beside(Plant):
    """In place of a plant: what the first run's senses at the same step, whatever is commanded."""

    def __init__(self, plant: Plant, first: _First) -> None:
        self.name, self.steps = plant.name, plant.steps
        self.reads, self.reads_past = plant.reads, plant.reads_past
        self.senses, self.shows = plant.senses, plant.shows
        self._first = first

    def start(self, batch: Batch) -> Any:
        return None

    def sense(self, state: Any) -> Mapping[str, Any]:
        return self._first.sensed

    def advance(self, state: Any, inputs: Inputs) -> Any:
        return state

    def progress(self, state: Any) -> Progress:
        assert self._first.stands is not None
        return self._first.stands

    def conditions(self, state: Any) -> tuple[Sequence[str], Sequence[str]]:
        return (), ()

    def over(self, state: Any, step: int) -> bool:
        return False


class _Taps:
    """Taps that record the first run's readings of the past, or deliver these in place of their
    own."""

    def __init__(self, first: _First, faults: Sequence[Fault], records: bool) -> None:
        treatment = Treatment(variant=first.variant, faults=tuple(faults), seed=first.seed)
        self._taps: Taps = taps_of(first.system, treatment, first.scenes)
        self._first, self._records = first, records
        self.set_active = self._taps.set_active

    def deliver(
        self, channel: str, reader: str, reading: Reading, step: int, scene: int | None = None
    ) -> Any:
        """Deliver as `Taps` does."""
        tap = (channel, reader)
        if tap in self._first.past:
            if self._records:
                self._first.readings[tap] = reading
            reading = self._first.readings[tap]
        return self._taps.deliver(channel, reader, reading, step, scene)


def _with_plant(loop: Loop, plant: Plant) -> Loop:
    return replace(loop, graph=replace(loop.graph, plant=plant))
