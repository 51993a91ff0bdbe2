"""Taps: the only place where a source's reading becomes what a reader gets."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import count
from types import MappingProxyType
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from faultpath.core.arrays import Array, differs, match_device, namespace, read_only, to_numpy
from faultpath.core.errors import UserError
from faultpath.core.text import unknown
from faultpath.faults import Fault
from faultpath.interface import Interface, modules
from faultpath.loop.corruption import corruptions
from faultpath.loop.delivery_log import DeliveryLog, Guard, StepCounter, check_reached
from faultpath.loop.reading import (
    MalformedReading,
    Query,
    Reading,
    TapError,
    WrittenTo,
)
from faultpath.loop.tap import DeliveryListener, Tap, delivery_error, wire
from faultpath.loop.trajectory import Trajectories

UNREAD = -1
"""Scene index of a delivery that no scene reads."""


@dataclass(frozen=True, slots=True)
class ModuleTaps:
    """The taps as one module sees them: its own deliveries."""

    module: str
    deliver: Callable[[str, str, Reading, int], Array]
    """`deliver(channel, place, reading, step)` for the reader `module.place`."""


class Taps:
    """The taps of one variant over one block of scenes, with the faults of one treatment.

    Args:
        interface: The system's interface.
        faults: As `faultpath.faults.resolve` returns them; several at one tap act in this order.
        scenes: Scene ids, one a row of every reading.
        dt_s: Length of a control step, s.
        seed: Seed of the faults' random numbers.
        bindings: Channel to source, where it is not the channel's first source.
        readers: Readers of this variant; `None`: all that are declared.
        privileged: Privileged sources that this treatment may read.
        guard: Give every reader a copy of its own, so that `verify` can name a reader that wrote
            into it. NumPy readings cannot be written to in any case.
        observer: Listener that every delivery is reported to.

    Raises:
        UserError: A name is unknown, or a fault names a reader that the variant does not have.
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
        self._interface = interface
        self._observer = observer
        self._scenes = tuple(scenes)
        self._active: Array = None
        self._active_on_device: Array = None
        """`_active` on the device of the latest readings."""
        self._trajectories = Trajectories(len(self._scenes))
        self._faulted, self._altered = StepCounter(), StepCounter()
        self._shared_value: Array = None
        self._shared_view: Array = None
        """Read-only view of `_shared_value`, which its readers share."""
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
        for reader, corruption in corruptions(faults, self._scenes, dt_s, seed):
            fault = corruption.fault
            if (fault.channel, reader) not in self._taps:
                raise UserError(
                    f"fault '{fault.describe()}' has no tap at '{reader}': spell out its readers "
                    "with faultpath.faults.resolve"
                )
            self._taps[fault.channel, reader].add(corruption)

    def deliver(
        self, channel: str, reader: str, reading: Reading, step: int, scene: int | None = None
    ) -> Array:
        """Return the value that `reader` gets of `channel` at control step `step`.

        Without a fault on this tap that is `reading.value` itself, uncopied; a NumPy array is
        returned as a read-only view. A second delivery in one step returns the value of the first.
        A query is returned as a function of a request; see `Query`.

        It counts as a read of all scenes, or of the one with the index `scene`. With `UNREAD`
        nobody reads, but faults act on the reading, so that those that hold readings do not
        depend on who reads when.

        Raises:
            UndeclaredReader: This variant has no such reader of the channel.
            IllegalRead: The reading is not of the bound source, is privileged, or of the future.
            MalformedReading: It is no reading or not as declared, differs from the step's first
                delivery, or `step` is before that of the last delivery.
            NotFinite: The first reading at this tap is not finite.
        """
        tap = self._taps.get((channel, reader))
        # One test for speed, at every delivery; `delivery_error` says which condition failed.
        if (
            tap is None
            or not isinstance(cast("Any", reading), Reading)
            or reading.source != tap.source
            or not tap.permitted
            or not 0 <= step >= reading.step
        ):
            raise delivery_error(self._interface, tap, channel, reader, reading, step)
        value = reading.value
        if scene == UNREAD and not tap.corruptions:
            return None
        if scene != UNREAD and not (tap.reads.deliveries or isinstance(value, Query)):
            tap.check_first(value, self._scenes)
        if step != tap.last_step:
            if step < tap.last_step:
                raise MalformedReading(
                    f"tap {tap}: step {step} comes after step {tap.last_step}; a new run needs "
                    "new taps"
                )
            tap.last_step, tap.value = step, value
            if isinstance(value, Query):
                tap.cached = partial(self._answer, tap, value, step, count())
            else:
                value = self._corrupted(tap, value, step) if tap.corruptions else value
                if isinstance(value, np.ndarray):
                    if value is not self._shared_value:
                        self._shared_value, self._shared_view = value, read_only(value)
                    value = self._shared_view
                elif tap.guard is not None:
                    value = tap.guard.copy_for_reader(value)
                tap.cached = value
        elif value is not tap.value:
            tap.check_same(value, step)
        if scene != UNREAD:
            self._note_read(tap, step, scene)
            if self._observer is not None:
                self._observer.delivered(tap, reading, step, tap.cached)
        return tap.cached

    def _note_read(self, tap: Tap, step: int, scene: int | None) -> None:
        """Count a read, once a step and scene."""
        if not tap.reads.add(step, scene) or isinstance(tap.value, Query):
            return  # of a query each answer is counted
        only = None if scene is None else np.arange(len(self._scenes)) == scene
        self._count(tap, step, only)
        self._trajectories.note(tap.cached, only)

    def _count(self, tap: Tap, step: int, only: NDArray[np.bool_] | None = None) -> None:
        """Count what faults did at a tap in this step, in all scenes or in `only` some."""
        for counter, mask in tap.marks:
            if only is not None and mask is not False:
                mask = only if mask is True else mask & match_device(only, mask)
            counter.note(step, mask)
            if counter is self._faulted and self._observer is not None:
                self._observer.faulted(step, mask)

    def _answer(
        self, tap: Tap, query: Query, step: int, numbers: Iterator[int], request: Any
    ) -> Any:
        """Answer a request to a query; `numbers` count the requests of its step."""
        if step != tap.last_step:
            raise MalformedReading(
                f"tap {tap}: the query of step {step} was asked in step {tap.last_step}; ask what "
                "was delivered in this step"
            )
        answer = read_only(query.answer(request))
        number, first = next(numbers), not tap.reads.answers
        tap.reads.answers += 1
        delivered = answer
        if first or tap.corruptions or tap.guard:
            clean = value = query.value(answer)
            if first:
                tap.check_first(value, self._scenes)
            if tap.corruptions:
                value = self._corrupted(tap, value, step, number)
                self._count(tap, step)
            if tap.guard is not None:
                value = tap.guard.copy_for_reader(value)
            if value is not clean:
                delivered = query.changed(answer, value)
        if self._observer is not None:
            self._observer.answered(tap, query, step, request, answer, delivered)
        return delivered

    def _corrupted(self, tap: Tap, reading: Array, step: int, request: int = 0) -> Array:
        """Return the value after all faults, and keep in the tap which scenes to count."""
        tap.check_shape(reading)
        value, faulted = reading, False
        marks: list[tuple[StepCounter, Any]] = []
        for corruption in tap.corruptions:
            value, in_force = corruption.apply(value, step, request)
            in_force = self._where_active(in_force, reading)
            marks.append((corruption.in_force, in_force))
            faulted = in_force if faulted is False else faulted | in_force
        if len(tap.corruptions) > 1:
            marks.append((tap.faulted, faulted))
        marks.append((self._faulted, faulted))
        if value is not reading and faulted is not False:
            altered = self._where_active(differs(value, reading), reading)
            marks += [(tap.altered, altered), (self._altered, altered)]
        tap.marks = tuple(marks)
        return value

    def set_active(self, mask: Array | None) -> None:
        """Set which scenes still run, bool `[B]`; `None`: all. Only these are counted."""
        self._active = self._active_on_device = mask
        self._trajectories.set_running(mask)

    def trajectory_hashes(self) -> tuple[str, ...]:
        """Return a hash a scene of its trajectory so far; this waits for the device."""
        return self._trajectories.hashes()

    def _where_active(self, mask: Any, reading: Array) -> Any:
        """Return `mask`, a bool or boolean array `[B]`, restricted to scenes that still run."""
        if self._active is None or mask is False:
            return mask
        active = self._active_on_device
        if namespace(active) is not namespace(reading) or active.device != reading.device:
            active = self._active_on_device = match_device(to_numpy(self._active), reading)
        return active if mask is True else mask & active

    def for_module(self, module: str) -> ModuleTaps:
        """Return the taps as `module` sees them; `TapError` for an unknown module."""
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

    def verify(self, last_step: NDArray[np.int64] | int | None = None) -> None:
        """Check that each fault reached the readers that it names, and no others.

        Args:
            last_step: The last control step at which each scene ran, `[B]` or one for all; `None`
                where these are not all scenes of the treatment, so that others may be reached.

        Raises:
            NotDelivered, FaultedElsewhere: See `DeliveryLog.check` and `check_reached`.
            NotFinite: A first reading on an accelerator was not finite.
            WrittenTo: A guarded reader wrote into its copy.
        """
        for tap in self._taps.values():
            tap.check_finite(self._scenes)
            if tap.guard is not None and tap.guard.written():
                raise WrittenTo(
                    f"tap {tap}: the reader wrote into the reading, which others may read too; "
                    "copy it before writing"
                )
        log = self.delivery_log()
        log.check(self._named)
        if last_step is not None:
            check_reached(log.counts(), np.broadcast_to(last_step, len(self._scenes)).tolist())
