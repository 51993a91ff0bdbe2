"""How far a variant's commands move when one source errs and everything else stays.

The probe of the paper, Section III-B, asked of the whole controller: `A_s = median |u(s') - u(s)|`.
A loop flies under correct inputs. Beside it, step by step, its modules run again on what its plant
senses and on the commands that it has executed, with the fault in force: histories are those of the
flight, and only what modules make of the faulty input differs, what they carry from step to step
included. The median is over the steps of all scenes while they run, of the distance between both
commands, each component as a fraction of its root mean square in the flight.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faultpath.arrays import is_array, to_numpy
from faultpath.execution.attempt import taps_of
from faultpath.faults import AnyFault
from faultpath.loop import Batch, Inputs, Loop, Plant, Progress
from faultpath.taps import Reading, Taps
from faultpath.trials import Arm, LoopSystem

Floats = NDArray[np.float64]


def command_responses(
    system: LoopSystem,
    variant: str,
    faults: Mapping[tuple[str, str], Sequence[AnyFault]],
    scenes: Sequence[str],
    seed: int,
) -> dict[tuple[str, str], float]:
    """Return the response to each arm's faults that do not stop the variant's modules.

    Arms are named as the caller likes. Empty where nothing that faultpath sees reaches the plant.
    Raises what the flight raises.
    """
    lead = _Lead()
    batch = Batch(tuple(scenes), seed, system.control_dt_s)
    flight = _taps(system, Arm(variant=variant, seed=seed), scenes, lead, leads=True)
    loop = system.loop(variant, seed)
    lead.past = {
        (port.channel, f"{part.name}.{port.place}")
        for part in loop.graph.parts
        for port in part.reads_past
    }
    beside: dict[tuple[str, str], Any] = {}
    for name, struck in faults.items():
        arm = Arm(variant=variant, faults=tuple(struck), seed=seed)
        other = system.loop(variant, seed)
        told = _with_plant(other, _Told(other.graph.plant, lead))
        beside[name] = told.execute(batch, _taps(system, arm, scenes, lead, leads=False))
    moved: dict[tuple[str, str], list[Floats]] = {name: [] for name in beside}
    commands: list[Floats] = []
    running: list[NDArray[np.bool_]] = []
    for instant in _with_plant(loop, _Heard(loop.graph.plant, lead)).execute(batch, flight):
        if not len(instant.inputs):
            break
        commands.append(_command(instant.inputs, len(scenes)))
        assert lead.progress is not None
        running.append(np.asarray(to_numpy(lead.progress.running), dtype=bool))
        for name in list(beside):
            try:
                moved[name].append(_command(next(beside[name]).inputs, len(scenes)))
            except Exception:  # whatever modules do that were not made for such an input
                del beside[name], moved[name]
    if not commands or commands[0].shape[1] == 0:
        return {}
    return _medians(np.stack(commands), moved, np.stack(running))


def _medians(
    commands: Floats,
    moved: Mapping[tuple[str, str], Sequence[Floats]],
    running: NDArray[np.bool_],
) -> dict[tuple[str, str], float]:
    """Return the median distances; `commands` `[T, B, D]`, `running` `[T, B]`."""
    size = np.sqrt(np.mean(commands[running] ** 2, axis=0))
    size[size == 0.0] = 1.0
    found: dict[tuple[str, str], float] = {}
    for name, others in moved.items():
        apart = (np.stack(others) - commands)[running] / size
        response = float(np.median(np.sqrt(np.mean(apart**2, axis=1))))
        if np.isfinite(response):
            found[name] = response
    return found


def _command(inputs: Inputs, scenes: int) -> Floats:
    """Return what reaches the plant, `[B, D]`."""
    parts = [
        np.asarray(to_numpy(inputs[port]), dtype=np.float64).reshape(scenes, -1)
        for port in inputs
        if is_array(inputs[port])
    ]
    return np.concatenate(parts, axis=1) if parts else np.empty((scenes, 0))


@dataclass
class _Lead:
    """What the flight shows of itself at the present step."""

    past: set[tuple[str, str]] = field(default_factory=set[tuple[str, str]])
    """Taps, by channel and consumer, at which a port reads what was held one step before."""
    sensed: Mapping[str, Any] = field(default_factory=dict[str, Any])
    progress: Progress | None = None
    readings: dict[tuple[str, str], Reading] = field(default_factory=dict[tuple[str, str], Reading])
    """Of the past, by tap."""


class _Taps(Taps):
    """Taps that note the flight's readings of the past, or deliver these in place of their own."""

    def __init__(self, *given: Any, lead: _Lead, leads: bool, **named: Any) -> None:
        super().__init__(*given, **named)
        self._lead, self._leads = lead, leads

    def deliver(self, channel: str, consumer: str, reading: Reading, step: int) -> Any:
        """Deliver as `Taps` does."""
        tap = (channel, consumer)
        if tap in self._lead.past:
            if self._leads:
                self._lead.readings[tap] = reading
            reading = self._lead.readings[tap]
        return super().deliver(channel, consumer, reading, step)


def _taps(system: LoopSystem, arm: Arm, scenes: Sequence[str], lead: _Lead, leads: bool) -> _Taps:
    return taps_of(system, arm, scenes, _Taps, lead=lead, leads=leads)


def _with_plant(loop: Loop, plant: Plant) -> Loop:
    return replace(loop, graph=replace(loop.graph, plant=plant))


class _Heard(Plant):
    """The plant of the flight, which lets others hear what it senses."""

    def __init__(self, plant: Plant, lead: _Lead) -> None:
        self.name, self.steps = plant.name, plant.steps
        self.reads, self.reads_past = plant.reads, plant.reads_past
        self.senses, self.shows = plant.senses, plant.shows
        self._plant, self._lead = plant, lead

    def start(self, batch: Batch) -> Any:
        return self._plant.start(batch)

    def sense(self, state: Any) -> Mapping[str, Any]:
        self._lead.sensed = self._plant.sense(state)
        return self._lead.sensed

    def advance(self, state: Any, inputs: Inputs) -> Any:
        return self._plant.advance(state, inputs)

    def progress(self, state: Any) -> Progress:
        self._lead.progress = self._plant.progress(state)
        return self._lead.progress

    def over(self, state: Any, step: int) -> bool:
        return self._plant.over(state, step)

    def conditions(self, state: Any) -> tuple[Sequence[str], Sequence[str]]:
        return self._plant.conditions(state)


class _Told(_Heard):
    """In place of a plant: what the flight's senses at the same step, whatever is commanded."""

    def start(self, batch: Batch) -> Any:
        return None

    def sense(self, state: Any) -> Mapping[str, Any]:
        return self._lead.sensed

    def advance(self, state: Any, inputs: Inputs) -> Any:
        return state

    def progress(self, state: Any) -> Progress:
        assert self._lead.progress is not None
        return self._lead.progress

    def over(self, state: Any, step: int) -> bool:
        return False
