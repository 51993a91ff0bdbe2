"""How far a variant's commands move when one source errs and everything else stays.

The probe of the paper, Section III-B, asked of the whole controller: `A_s = median |u(s') - u(s)|`.
A loop flies under correct inputs. Beside it, step by step, its modules run again on what its plant
senses and on the commands that it has executed, with the fault in force: histories are those of the
flight, and only what modules make of the faulty input differs, what they carry from step to step
included. The median is over the steps of all scenes while they run, of the distance between both
commands, each component as a fraction of its root mean square in the flight.
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
from faultpath.loop import Batch, Inputs, Loop, Plant, Progress
from faultpath.loop.taps import Reading, Taps
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

    Empty where nothing that faultpath sees reaches the plant. Raises what the flight raises.
    """
    beside = _Beside(system, variant, faults, scenes, seed)
    loop = system.loop(variant, seed)
    heard = _with_plant(loop, _Heard(loop.graph.plant, beside))
    beside.past = {
        (port.channel, f"{part.name}.{port.place}")
        for part in loop.graph.parts
        for port in part.reads_past
    }
    system.fly(heard, scenes, beside.taps((), leads=True), seed)
    return beside.medians()


class _Beside:
    """What the flight shows of itself, and the modules that run beside it."""

    def __init__(
        self,
        system: LoopSystem,
        variant: str,
        faults: Mapping[Key, Sequence[AnyFault]],
        scenes: Sequence[str],
        seed: int,
    ) -> None:
        self._system, self._variant, self._faults = system, variant, faults
        self._scenes, self._seed = tuple(scenes), seed
        self.past: set[tuple[str, str]] = set()
        """Taps, by channel and consumer, at which a port reads what was held one step before."""
        self.readings: dict[tuple[str, str], Reading] = {}
        """Of the past, at the flight's present step."""
        self.sensed: Mapping[str, Any] = {}
        self.progress: Progress | None = None
        self._others: dict[Key, Any] = {}
        self._moved: dict[Key, list[Floats]] = {key: [] for key in faults}
        self._commands: list[Floats] = []
        self._running: list[NDArray[np.bool_]] = []

    def taps(self, faults: Sequence[AnyFault], leads: bool) -> "_Taps":
        arm = Arm(variant=self._variant, faults=tuple(faults), seed=self._seed)
        return _Taps(taps_of(self._system, arm, self._scenes), self, leads)

    def step(self, inputs: Inputs) -> None:
        """Take in a command of the flight, and let the others make theirs."""
        if not self._commands:
            self._others = {key: self._begin(faults) for key, faults in self._faults.items()}
        assert self.progress is not None
        self._commands.append(self._command(inputs))
        self._running.append(np.array(to_numpy(self.progress.running), dtype=bool))
        for key in list(self._others):
            try:
                self._moved[key].append(self._command(next(self._others[key]).inputs))
            except Exception as error:  # what modules raise that were not made for such an input
                del self._others[key], self._moved[key]
                told = f"{' '.join(map(str, key))}, {self._variant}: no probe response, since its "
                told += f"modules stop at such an input ({described(error)})."
                warnings.warn(Notice(told), stacklevel=1)

    def _begin(self, faults: Sequence[AnyFault]) -> Any:
        loop = self._system.loop(self._variant, self._seed)
        batch = Batch(self._scenes, self._seed, self._system.control_dt_s)
        told = _with_plant(loop, _Told(loop.graph.plant, self))
        return told.execute(batch, self.taps(faults, leads=False))

    def _command(self, inputs: Inputs) -> Floats:
        n = len(self._scenes)
        parts = [
            np.array(to_numpy(inputs[port]), dtype=np.float64).reshape(n, -1)
            for port in inputs
            if is_array(inputs[port])
        ]
        return np.concatenate(parts, axis=1) if parts else np.empty((n, 0))

    def medians(self) -> dict[Key, float]:
        """Return the median distances, where they are finite."""
        if not self._commands or self._commands[0].shape[1] == 0:
            return {}
        commands, running = np.stack(self._commands), np.stack(self._running)
        size = np.sqrt(np.mean(commands[running] ** 2, axis=0))
        size[size == 0.0] = 1.0
        found: dict[Key, float] = {}
        for key, moved in self._moved.items():
            apart = (np.stack(moved) - commands)[running] / size
            median = float(np.median(np.sqrt(np.mean(apart**2, axis=1))))
            found[key] = float(f"{median:.6g}")  # what rounding parts is equal
        return {key: value for key, value in found.items() if np.isfinite(value)}


class _Taps:
    """Taps that note the flight's readings of the past, or deliver these in place of their own."""

    def __init__(self, taps: Taps, beside: _Beside, leads: bool) -> None:
        self._taps, self._beside, self._leads = taps, beside, leads
        self.set_active = taps.set_active

    def deliver(self, channel: str, consumer: str, reading: Reading, step: int) -> Any:
        """Deliver as `Taps` does."""
        tap = (channel, consumer)
        if tap in self._beside.past:
            if self._leads:
                self._beside.readings[tap] = reading
            reading = self._beside.readings[tap]
        return self._taps.deliver(channel, consumer, reading, step)


def _with_plant(loop: Loop, plant: Plant) -> Loop:
    return replace(loop, graph=replace(loop.graph, plant=plant))


class _Heard(Plant):
    """The plant of the flight; others hear what it senses, and run before it moves."""

    def __init__(self, plant: Plant, beside: _Beside) -> None:
        self.name, self.steps = plant.name, plant.steps
        self.reads, self.reads_past = plant.reads, plant.reads_past
        self.senses, self.shows = plant.senses, plant.shows
        self._plant, self._beside = plant, beside

    def start(self, batch: Batch) -> Any:
        return self._plant.start(batch)

    def sense(self, state: Any) -> Mapping[str, Any]:
        self._beside.sensed = self._plant.sense(state)
        return self._beside.sensed

    def advance(self, state: Any, inputs: Inputs) -> Any:
        self._beside.step(inputs)
        return self._plant.advance(state, inputs)

    def progress(self, state: Any) -> Progress:
        self._beside.progress = self._plant.progress(state)
        return self._beside.progress

    def conditions(self, state: Any) -> tuple[Sequence[str], Sequence[str]]:
        return self._plant.conditions(state)

    def over(self, state: Any, step: int) -> bool:
        return self._plant.over(state, step)

    def position(self, state: Any) -> Array | None:
        return self._plant.position(state)


class _Told(_Heard):
    """In place of a plant: what the flight's senses at the same step, whatever is commanded."""

    def start(self, batch: Batch) -> Any:
        return None

    def sense(self, state: Any) -> Mapping[str, Any]:
        return self._beside.sensed

    def advance(self, state: Any, inputs: Inputs) -> Any:
        return state

    def progress(self, state: Any) -> Progress:
        assert self._beside.progress is not None
        return self._beside.progress

    def over(self, state: Any, step: int) -> bool:
        return False
