"""How far a variant's commands move when one source errs and everything else stays.

The probe of the paper, Section III-B, asked of the whole controller: `A_s = median |u(s') - u(s)|`.
A loop runs under correct inputs. Beside it, step by step, its modules run again on what its plant
senses and on the commands that it has executed, with the fault in force: histories are those of the
first run, and only what modules make of the faulty input differs, what they carry from step to step
included. The median is over the steps of all scenes while they run, of the distance between both
commands, each component as a fraction of its root mean square in the first run.
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.core.arrays import Array, is_array, to_numpy
from faultpath.core.error_source import described
from faultpath.core.errors import Notice
from faultpath.faults import AnyFault
from faultpath.loop import Batch, Inputs, Loop, Plant, Progress, Reading, Taps
from faultpath.trials import Arm, LoopSystem
from faultpath.trials.attempt import taps_of

Floats: TypeAlias = NDArray[np.float64]
Key: TypeAlias = tuple[str, str]
"""What the caller calls an arm."""


def command_responses(
    system: LoopSystem,
    variant: str,
    faults: Mapping[Key, Sequence[AnyFault]],
    scenes: Sequence[str],
    seed: int,
) -> dict[Key, float]:
    """Return the response to each arm's faults that do not stop the variant's modules.

    Empty where nothing that faultpath sees reaches the plant. Raises what the run raises.
    """
    probe = _Probe(system, variant, faults, tuple(scenes), seed)
    loop = system.loop(variant, seed)
    probe.past = {
        (port.channel, f"{part.name}.{port.place}")
        for part in loop.graph.parts
        for port in part.reads_past
    }
    observed = _with_plant(loop, _Observed(loop.graph.plant, probe))
    system.execute(observed, scenes, _Taps(probe, (), first=True), seed)
    if not probe.commands or probe.commands[0].shape[1] == 0:
        return {}
    commands, running = np.stack(probe.commands), np.stack(probe.running)
    size = np.sqrt(np.mean(commands[running] ** 2, axis=0))
    size[size == 0.0] = 1.0
    found: dict[Key, float] = {}
    for key, moved in probe.moved.items():
        apart = (np.stack(moved) - commands)[running] / size
        median = float(np.median(np.sqrt(np.mean(apart**2, axis=1))))
        if np.isfinite(median):
            found[key] = float(f"{median:.6g}")  # what rounding parts is equal
    return found


class _Probe:
    """What the first run shows of itself, and the modules that run beside it."""

    def __init__(
        self,
        system: LoopSystem,
        variant: str,
        faults: Mapping[Key, Sequence[AnyFault]],
        scenes: tuple[str, ...],
        seed: int,
    ) -> None:
        self.system, self.variant, self.scenes, self.seed = system, variant, scenes, seed
        self.past: set[tuple[str, str]] = set()
        """Taps, by channel and consumer, at which a port reads what was held one step before."""
        self.readings: dict[tuple[str, str], Reading] = {}
        """Of the past, at the first run's present step."""
        self.sensed: Mapping[str, Any] = {}
        self.progress: Progress | None = None
        self.moved: dict[Key, list[Floats]] = {key: [] for key in faults}
        self.commands: list[Floats] = []
        self.running: list[NDArray[np.bool_]] = []
        self._faults = faults
        self._others: dict[Key, Any] = {}

    def step(self, inputs: Inputs) -> None:
        """Take in a command of the first run, and let the others make theirs."""
        if not self.commands:
            batch = Batch(self.scenes, self.seed, self.system.control_dt_s)
            for key, faults in self._faults.items():
                loop = self.system.loop(self.variant, self.seed)
                beside = _with_plant(loop, _Copied(loop.graph.plant, self))
                self._others[key] = beside.execute(batch, _Taps(self, faults, first=False))
        assert self.progress is not None
        self.commands.append(self._command(inputs))
        self.running.append(np.array(to_numpy(self.progress.running), dtype=bool))
        for key in list(self._others):
            try:
                self.moved[key].append(self._command(next(self._others[key]).inputs))
            except Exception as error:  # what modules raise that were not made for such an input
                del self._others[key], self.moved[key]
                said = f"{' '.join(map(str, key))}, {self.variant}: no probe response, since its "
                said += f"modules stop at such an input ({described(error)})."
                warnings.warn(Notice(said), stacklevel=1)

    def _command(self, inputs: Inputs) -> Floats:
        n = len(self.scenes)
        parts = [
            np.array(to_numpy(inputs[port]), dtype=np.float64).reshape(n, -1)
            for port in inputs
            if is_array(inputs[port])
        ]
        return np.concatenate(parts, axis=1) if parts else np.empty((n, 0))


class _Taps:
    """Taps that note the first run's readings of the past, or deliver these instead of their
    own."""

    def __init__(self, probe: _Probe, faults: Sequence[AnyFault], first: bool) -> None:
        arm = Arm(variant=probe.variant, faults=tuple(faults), seed=probe.seed)
        self._taps: Taps = taps_of(probe.system, arm, probe.scenes)
        self._probe, self._first = probe, first
        self.set_active = self._taps.set_active

    def deliver(self, channel: str, consumer: str, reading: Reading, step: int) -> Any:
        """Deliver as `Taps` does."""
        tap = (channel, consumer)
        if tap in self._probe.past:
            if self._first:
                self._probe.readings[tap] = reading
            reading = self._probe.readings[tap]
        return self._taps.deliver(channel, consumer, reading, step)


def _with_plant(loop: Loop, plant: Plant) -> Loop:
    return replace(loop, graph=replace(loop.graph, plant=plant))


class _Observed(Plant):
    """The plant of the first run; others get what it senses, and run before it moves."""

    def __init__(self, plant: Plant, probe: _Probe) -> None:
        self.name, self.steps = plant.name, plant.steps
        self.reads, self.reads_past = plant.reads, plant.reads_past
        self.senses, self.shows = plant.senses, plant.shows
        self._plant, self._probe = plant, probe

    def start(self, batch: Batch) -> Any:
        return self._plant.start(batch)

    def sense(self, state: Any) -> Mapping[str, Any]:
        self._probe.sensed = self._plant.sense(state)
        return self._probe.sensed

    def advance(self, state: Any, inputs: Inputs) -> Any:
        self._probe.step(inputs)
        return self._plant.advance(state, inputs)

    def progress(self, state: Any) -> Progress:
        self._probe.progress = self._plant.progress(state)
        return self._probe.progress

    def conditions(self, state: Any) -> tuple[Sequence[str], Sequence[str]]:
        return self._plant.conditions(state)

    def over(self, state: Any, step: int) -> bool:
        return self._plant.over(state, step)

    def position(self, state: Any) -> Array | None:
        return self._plant.position(state)


class _Copied(_Observed):
    """In place of a plant: what the first run's senses at the same step, whatever is commanded."""

    def start(self, batch: Batch) -> Any:
        return None

    def sense(self, state: Any) -> Mapping[str, Any]:
        return self._probe.sensed

    def advance(self, state: Any, inputs: Inputs) -> Any:
        return state

    def progress(self, state: Any) -> Progress:
        assert self._probe.progress is not None
        return self._probe.progress

    def over(self, state: Any, step: int) -> bool:
        return False
