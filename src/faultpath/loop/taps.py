"""Taps: the only place where a source's reading becomes what a reader gets."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import count
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faultpath.core.arrays import Array, differs, namespace, place, read_only, to_numpy
from faultpath.core.errors import UserError
from faultpath.core.text import unknown
from faultpath.faults import Draws, Fault
from faultpath.interface import Interface, modules
from faultpath.loop.delivery_log import DeliveryLog, Guard, StepCounter
from faultpath.loop.reading import (
    MalformedReading,
    Query,
    Reading,
    TapError,
    WrittenTo,
)
from faultpath.loop.tap import Corruption, DeliveryListener, Tap, refusal, wire
from faultpath.loop.trajectory import Trajectories


@dataclass(frozen=True, slots=True)
class ModuleTaps:
    """All that a module under test sees of the taps: its own deliveries."""

    module: str
    deliver: Callable[[str, str, Reading, int], Array]
    """`deliver(channel, place, reading, step)` for the reader `module.place`."""


class Taps:
    """The taps of one variant over one block of scenes, with the faults of one treatment.

    Args:
        interface: The system's interface.
        faults: As `faultpath.faults.resolve` returns them, in the order in which they act where
            they meet at a tap.
        scenes: Scene ids, one a row of every reading.
        dt_s: Length of a control step, s.
        seed: Seed of the faults' random numbers.
        bindings: Channel to the source that feeds it here; the rest keep their first source.
        readers: Readers that this variant has; `None`: all that are declared.
        privileged: Privileged sources that this treatment may read.
        guard: Give every reader a copy of its own and let `verify` tell who wrote into it. NumPy
            readings cannot be written to in any case.
        observer: Sees what is delivered.

    Raises:
        UserError: A name is unknown, or a fault names a reader that is not here.
    """

    def __init__(
        self,
        interface: Interface,
        faults: Iterable[Fault] = (),
        *,
        scenes: tuple[str, ...],
        dt_s: float,
        seed: int = 0,
        bindings: Mapping[str, str] | None = None,
        readers: Collection[str] | None = None,
        privileged: Collection[str] = (),
        guard: bool = False,
        observer: DeliveryListener | None = None,
    ) -> None:
        self._refusal = partial(refusal, interface)
        self._interface = interface
        self._observer = observer
        self._scenes = tuple(scenes)
        self._active: Array = None
        self._placed: Array = None
        self._trajectories = Trajectories(len(self._scenes))
        self._faulted, self._altered = StepCounter(), StepCounter()
        self._open: Array = None
        self._closed: Array = None
        self._taps = wire(interface, bindings or {}, readers, privileged, len(scenes))
        for tap in self._taps.values() if guard else ():
            tap.guard = Guard()
        first = {channel.name: channel.sources[0] for channel in interface.channels}
        self.bindings: Mapping[str, str] = MappingProxyType(first | dict(bindings or {}))
        """The source that feeds each channel here."""
        faults = tuple(faults)
        self._named: Mapping[tuple[str, str], list[str]] = {}
        for fault in faults:
            for reader in fault.readers:
                self._named.setdefault((fault.channel, reader), []).append(fault.describe())
        self._add(faults, dt_s, seed)

    def _add(self, faults: Iterable[Fault], dt_s: float, seed: int) -> None:
        shared: dict[Draws, Draws] = {}
        apart: dict[Draws | None, Fault] = {}
        for fault in faults:
            draws = fault.draws(self._scenes, seed)
            if abs(fault.loading) < 1:
                if draws.own in apart:
                    raise UserError(
                        f"faults '{apart[draws.own].describe()}' and '{fault.describe()}' have "
                        "a loading and draw the same numbers nevertheless: give them different "
                        "causes"
                    )
                apart[draws.own] = fault
            common = shared.setdefault(draws, draws)
            for reader in fault.readers:
                if (fault.channel, reader) not in self._taps:
                    raise UserError(
                        f"fault '{fault.describe()}' has no tap at '{reader}': spell out its "
                        "readers with faultpath.faults.resolve"
                    )
                self._taps[fault.channel, reader].add(Corruption(fault, common, dt_s))

    def deliver(self, channel: str, reader: str, reading: Reading, step: int) -> Array:
        """Return what `reader` gets of `channel` at control step `step`.

        Without a fault on this tap that is `reading.value` itself, uncopied; a NumPy array comes
        as a view that cannot be written to. A second delivery in one step returns what the first
        did, with a fault or without. A query comes as a function of its request; see `Query`.

        Raises:
            UndeclaredReader: This variant has no such reader of the channel.
            IllegalRead: The reading is not of the bound source, is privileged, or of the future.
            MalformedReading: It is no reading or not as declared, differs from that of the step's
                first delivery, or `step` is before the last one.
            NotFinite: The first reading at this tap is not finite.
        """
        tap = self._taps.get((channel, reader))
        if tap is None:
            raise self._refusal(tap, channel, reader, reading, step)
        try:
            value = reading.value
            if step < 0:
                raise MalformedReading(f"tap {tap}: step {step} is before the first, which is 0")
            if reading.source != tap.source or not tap.permitted or reading.step > step:
                raise self._refusal(tap, channel, reader, reading, step)
        except AttributeError:
            raise self._refusal(tap, channel, reader, reading, step) from None
        if step != tap.last_step:
            if step < tap.last_step:
                raise MalformedReading(
                    f"tap {tap}: step {step} comes after step {tap.last_step}; a new run needs "
                    "new taps"
                )
            if not (tap.deliveries or isinstance(value, Query)):
                tap.check_first(value, self._scenes)
            tap.last_step = step
            tap.deliveries += 1
            tap.value = value
            if isinstance(value, Query):
                got = partial(self._answer, tap, value, step, count())
            else:
                got = self._corrupted(tap, value, step) if tap.corruptions else value
                if isinstance(got, np.ndarray):
                    if got is not self._open:  # readers of one array share the view of it
                        self._open, self._closed = got, read_only(got)
                    got = self._closed
                elif tap.guard is not None:
                    got = tap.guard.hand_out(got)
                self._trajectories.note(got)
            tap.cached = got
        elif value is not tap.value:
            tap.check_same(value, step)
        if self._observer is not None:
            self._observer.delivered(tap, reading, step, tap.cached)
        return tap.cached

    def _answer(
        self, tap: Tap, query: Query, step: int, numbers: Iterator[int], request: Any
    ) -> Any:
        """Answer a request to a query; `numbers` count those of its step."""
        if step != tap.last_step:
            raise MalformedReading(
                f"tap {tap}: the query of step {step} was asked in step {tap.last_step}; ask what "
                "was delivered in this step"
            )
        answer = read_only(query.answer(request))
        ask, first = next(numbers), not tap.answers
        tap.answers += 1
        got = answer
        if first or tap.corruptions or tap.guard:
            clean = value = query.value(answer)
            if first:
                tap.check_first(value, self._scenes)
            if tap.corruptions:
                value = self._corrupted(tap, value, step, ask)
            if tap.guard is not None:
                value = tap.guard.hand_out(value)
            if value is not clean:
                got = query.changed(answer, value)
        if self._observer is not None:
            self._observer.answered(tap, query, step, request, answer, got)
        return got

    def _corrupted(self, tap: Tap, reading: Array, step: int, ask: int = 0) -> Array:
        tap.check_shape(reading)
        value, faulted = reading, False
        for corruption in tap.corruptions:
            value, in_force = corruption.act(value, step, ask)
            in_force = self._running(in_force, reading)
            corruption.in_force.note(step, in_force)
            faulted = in_force if faulted is False else faulted | in_force
        if len(tap.corruptions) > 1:
            tap.faulted.note(step, faulted)
        self._faulted.note(step, faulted)
        if self._observer is not None:
            self._observer.faulted(step, faulted)
        if value is not reading and faulted is not False:
            altered = self._running(differs(value, reading), reading)
            tap.altered.note(step, altered)
            self._altered.note(step, altered)
        return value

    def set_active(self, mask: Array | None) -> None:
        """Set which scenes still run, bool `[B]`; `None`: all. Only these are counted."""
        self._active = self._placed = mask
        self._trajectories.set_running(mask)

    def trajectory_hashes(self) -> tuple[str, ...]:
        """Return a hash a scene of all that its readers got while it ran; waits for the device."""
        return self._trajectories.hashes()

    def _running(self, mask: Any, reading: Array) -> Any:
        """Return `mask`, a bool or boolean array `[B]`, where the scene runs."""
        if self._active is None or mask is False:
            return mask
        placed = self._placed
        if namespace(placed) is not namespace(reading) or placed.device != reading.device:
            placed = self._placed = place(to_numpy(self._active), reading)
        return placed if mask is True else mask & placed

    def for_module(self, module: str) -> ModuleTaps:
        """Return the view that `module` gets; raises `TapError` for an unknown module."""
        if module not in modules(self._interface):
            raise TapError(unknown("module", module, modules(self._interface)))

        def deliver(channel: str, place: str, reading: Reading, step: int) -> Array:
            return self.deliver(channel, f"{module}.{place}", reading, step)

        return ModuleTaps(module, deliver)

    def delivery_log(self) -> DeliveryLog:
        """Return the log so far; this waits for the device that holds the counts."""
        n = len(self._scenes)
        return DeliveryLog(
            scenes=self._scenes,
            taps=tuple(tap.log(n) for tap in self._taps.values()),
            steps_faulted=self._faulted.counts(n),
            steps_altered=self._altered.counts(n),
        )

    def verify(self, last_step: NDArray[np.int64] | int) -> None:
        """Check that each fault reached the readers that it names, and nobody else.

        `last_step`: the last control step at which each scene ran, `[B]` or one for all. Raises as
        `DeliveryLog.check`, `NotFinite` for a first reading on an accelerator, and `WrittenTo` of a
        guarded reader that wrote.
        """
        for tap in self._taps.values():
            tap.check_finite(self._scenes)
            if tap.guard is not None and tap.guard.written():
                raise WrittenTo(
                    f"tap {tap}: the reader wrote into the reading, which others may read too; "
                    "copy it before writing"
                )
        last = np.broadcast_to(np.asarray(last_step, dtype=np.int64), (len(self._scenes),))
        self.delivery_log().check(self._named, last)
