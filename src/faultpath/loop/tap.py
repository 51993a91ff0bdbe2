"""One tap: the checks of its readings, and its counts."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np

from faultpath.core.arrays import (
    Array,
    HostArray,
    device_kind,
    differs,
    is_array,
    namespace,
    to_numpy,
)
from faultpath.core.errors import UserError
from faultpath.core.text import listed, unknown
from faultpath.interface import Interface, Provenance
from faultpath.loop.corruption import Corruption, fractional
from faultpath.loop.delivery_log import FaultLog, Guard, StepCounter, TapLog
from faultpath.loop.reading import (
    IllegalRead,
    MalformedReading,
    NotFinite,
    Query,
    Reading,
    TapError,
    UndeclaredReader,
)


@dataclass(slots=True)
class ReadCount:
    """How often a tap was read."""

    deliveries: int = 0
    """Steps in which a scene read."""
    answers: int = 0
    """Answers of queries, over all steps."""
    step: int = -1
    """The last step in which a scene read."""
    scenes: set[int] | None = None
    """Scenes that read in that step; `None`: all."""

    def add(self, step: int, scene: int | None) -> bool:
        """Count a read; return whether it is the first of its scene in this step."""
        if step != self.step:
            self.step, self.deliveries = step, self.deliveries + 1
            self.scenes = None if scene is None else {scene}
            return True
        if self.scenes is None or scene in self.scenes:
            return False
        if scene is None:
            self.scenes = None
        else:
            self.scenes.add(scene)
        return True


@dataclass(slots=True, eq=False)
class Tap:
    """A channel as one reader gets it."""

    channel: str
    reader: str
    source: str
    permitted: bool
    shape: tuple[int, ...]
    """Shape of every reading, scenes first."""
    corruptions: tuple[Corruption, ...] = ()
    reads: ReadCount = field(default_factory=ReadCount)
    last_step: int = -1
    value: Array = None
    """Value of this step's reading, before any fault."""
    cached: Array = None
    """Value delivered this step."""
    marks: tuple[tuple[StepCounter, Any], ...] = ()
    """Scenes to count in this step: those in which faults are in force, and altered readings."""
    finite: Array = None
    """Mask of the first reading's finite numbers, until it has been checked."""
    guard: Guard | None = None
    faulted: StepCounter = field(default_factory=StepCounter)
    altered: StepCounter = field(default_factory=StepCounter)

    def __str__(self) -> str:
        return f"{self.channel} -> {self.reader}"

    def add(self, corruption: Corruption) -> None:
        """Let a fault act here. A single fault's counter serves the whole tap."""
        self.corruptions = (*self.corruptions, corruption)
        self.faulted = corruption.in_force if len(self.corruptions) == 1 else StepCounter()

    def log(self, n_scenes: int) -> TapLog:
        """Return the log so far; this waits for the device that holds the counts."""
        return TapLog(
            channel=self.channel,
            reader=self.reader,
            deliveries=self.reads.deliveries,
            answers=self.reads.answers,
            faults=tuple(
                FaultLog(
                    corruption.fault.describe(),
                    corruption.fault.onset_step,
                    corruption.in_force.counts(n_scenes),
                )
                for corruption in self.corruptions
            ),
            steps_faulted=self.faulted.counts(n_scenes),
            steps_altered=self.altered.counts(n_scenes),
        )

    def check_first(self, value: Any, scenes: tuple[str, ...]) -> None:
        """Check the first value: an array of real numbers, as declared, all of them finite.

        Raises `MalformedReading`, and `NotFinite` at once where the value is on the host; on an
        accelerator that waits for `check_finite`, so that no delivery waits for the device.
        """
        if not is_array(value):
            raise MalformedReading(
                f"tap {self}: the reading's value is a {type(value).__name__}: give an array with "
                "one row a scene"
            )
        self.check_shape(value)
        if not _real(value):
            raise MalformedReading(
                f"tap {self}: the reading is of {value.dtype}; a source gives real numbers or "
                "truths"
            )
        if fractional(value):
            self.finite = namespace(value).isfinite(value)
            if device_kind(value) == "cpu":
                self.check_finite(scenes)

    def check_shape(self, value: Array) -> None:
        """Raise `MalformedReading` unless the shape is the declared one."""
        if getattr(value, "shape", ()) == self.shape:
            return
        shape, declared = list(getattr(value, "shape", ())), list(self.shape)
        if shape == declared:
            return
        if shape[:1] != declared[:1]:
            rows = str(shape[0]) if shape else "no"
            raise MalformedReading(
                f"tap {self}: the reading has {rows} rows for {declared[0]} scenes: its shape is "
                f"{shape}, and has to be {declared}, one row a scene"
            )
        raise MalformedReading(
            f"tap {self}: the reading of one scene has the shape {shape[1:]}, but source "
            f"'{self.source}' declares `shape: {declared[1:]}`: declare `shape: {shape[1:]}` "
            "there, or deliver what is declared"
        )

    def check_finite(self, scenes: tuple[str, ...]) -> None:
        """Raise `NotFinite` if the first value was not finite; this waits for the device."""
        if self.finite is None:
            return
        finite, self.finite = to_numpy(self.finite), None
        failed = np.flatnonzero(~finite.reshape(len(scenes), -1).all(axis=1))
        if failed.size:
            raise NotFinite(
                f"tap {self}: the first reading is not finite in {failed.size} of {len(scenes)} "
                f"scenes, '{scenes[failed[0]]}' for one"
            )

    def check_same(self, value: Any, step: int) -> None:
        """Raise `MalformedReading` if a second delivery in a step has another reading.

        On an accelerator values are not compared, because no delivery waits for the device.
        """
        same = is_array(value) and tuple(value.shape) == self.shape
        if same and device_kind(value) == device_kind(self.value) == "cpu":
            same = not to_numpy(differs(value, self.value)).any()
        if not same:
            raise MalformedReading(
                f"tap {self}: step {step} brings two different readings, but a channel has one in "
                "a step; deliver it once, or declare a channel for each"
            )


def _real(value: Array) -> bool:
    if isinstance(value, np.ndarray):
        return cast(HostArray, value).dtype.kind in "biuf"
    return bool(namespace(value).isdtype(value.dtype, ("bool", "integral", "real floating")))


def wire(
    interface: Interface,
    bindings: Mapping[str, str],
    readers: Collection[str] | None,
    privileged: Collection[str],
    n_scenes: int,
) -> dict[tuple[str, str], Tap]:
    """Return the taps of a variant by channel and reader; raises `UserError` for wrong names."""
    for name in bindings:
        interface.channel(name)
    for name in privileged:
        interface.source(name)
    declared = {name for channel in interface.channels for name in channel.readers}
    for name in readers or ():
        if name not in declared:
            raise UserError(f"this variant's readers: {unknown('reader', name, declared)}")
    taps: dict[tuple[str, str], Tap] = {}
    for channel in interface.channels:
        bound = bindings.get(channel.name, channel.sources[0])
        if bound not in channel.sources:
            problem = unknown("source", bound, channel.sources)
            raise UserError(f"channel '{channel.name}' cannot be bound: {problem}")
        source = interface.source(bound)
        is_privileged = source.provenance is Provenance.PRIVILEGED
        shape = (n_scenes, *source.shape)
        for name in channel.readers:
            if readers is None or name in readers:
                permitted = bound in privileged or not is_privileged
                taps[channel.name, name] = Tap(channel.name, name, bound, permitted, shape)
    return taps


class DeliveryListener:
    """Listener to the deliveries of one run; a subclass overrides the methods it needs.

    It gets the arrays of the run itself, so it copies what it keeps and writes to none.
    """

    def delivered(self, tap: Tap, reading: Reading, step: int, got: Any) -> None:
        """Handle the value that a reader got; for a query, the function that answers."""

    def answered(
        self, tap: Tap, query: Query, step: int, request: Any, answer: Any, got: Any
    ) -> None:
        """Handle a query's answer to a request, and the answer that the reader got."""

    def faulted(self, step: int, in_force: Any) -> None:
        """Handle the scenes in which a fault was in force at a tap: a bool, or bool `[B]`."""


def delivery_error(
    interface: Interface, tap: Tap | None, channel: str, reader: str, reading: Any, step: int
) -> TapError:
    """Return the error for a delivery that the interface or the variant does not allow."""
    here = f"tap {channel} -> {reader}"
    if tap is None:
        declared = interface.channel(channel).readers
        if reader in declared:
            return UndeclaredReader(
                f"{here}: this variant has no such reader; name it in the variant's readers"
            )
        return UndeclaredReader(
            f"{here}: the channel does not declare this reader; add it to the interface, "
            f"declared: {listed(declared)}"
        )
    if not isinstance(reading, Reading):
        return MalformedReading(
            f"{here}: deliver() was given a {type(reading).__name__}; wrap it: "
            f"Reading(value, '{tap.source}', step)"
        )
    if step < 0:
        return MalformedReading(f"{here}: step {step} is before the first, which is 0")
    if reading.source != tap.source:
        return IllegalRead(
            f"{here}: the reading is of source '{reading.source}', but the channel is bound to "
            f"'{tap.source}'; deliver that one, or bind the channel in the variant"
        )
    if not tap.permitted:
        return IllegalRead(
            f"{here}: source '{tap.source}' is privileged and this treatment does not permit it; "
            "read another one, or name it in the variant's privileged sources"
        )
    return IllegalRead(
        f"{here}: the reading is of step {reading.step}, which is after step {step}; deliver "
        "what is known by then"
    )
