"""The delivery log: at how many steps each reader got a faulted or altered value."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faultpath.core.arrays import Array, copy, differs, namespace, to_numpy, together
from faultpath.loop.reading import FaultedElsewhere, NotDelivered, UndeclaredReader


class StepCounter:
    """Counts the steps at which something held, scene by scene.

    Counts stay on the device of the masks, so that counting costs no host wait. A step that several
    taps report counts once.
    """

    __slots__ = ("_done", "_pending", "_step")

    def __init__(self) -> None:
        self._done: Any = 0
        self._pending: Any = False
        self._step = -1

    def note(self, step: int, mask: Any) -> None:
        """Report where something held at `step`; `mask` is a bool or boolean array `[B]`."""
        if step != self._step:
            self._done, self._pending, self._step = self._total(), mask, step
        elif self._pending is False:
            self._pending = mask
        elif mask is not False:
            one, other = together(self._pending, mask)
            self._pending = one | other

    def _total(self) -> Any:
        if self._pending is False:
            return self._done
        done, pending = together(self._done, self._pending)
        return done + pending

    def counts(self, n_scenes: int) -> NDArray[np.int64]:
        """Return the counts `[B]`; this waits for the device."""
        total = to_numpy(self._total()).astype(np.int64)
        return np.broadcast_to(total, (n_scenes,)).copy()


class Guard:
    """Gives a tap's reader copies, and compares each afterwards with one of its own.

    NumPy arrays need no guard, because readers get read-only views of them.
    """

    __slots__ = ("_copy", "_original", "_written")

    def __init__(self) -> None:
        self._copy: Array = None
        self._original: Array = None
        self._written: Any = False

    def copy_for_reader(self, value: Array) -> Array:
        """Return a copy for the reader, and check the one it had before."""
        self._compare()
        self._copy, self._original = copy(value), copy(value)
        return self._copy

    def written(self) -> bool:
        """Return whether a reader wrote into a copy; this waits for the device."""
        self._compare()
        return bool(to_numpy(self._written))

    def _compare(self) -> None:
        if self._copy is not None:
            unequal = differs(self._copy, self._original)
            self._written = self._written | namespace(unequal).any(unequal)


@dataclass(frozen=True, slots=True)
class TapCount:
    """Counts of one tap, summed over scenes; stored with every run."""

    channel: str
    reader: str
    deliveries: int
    """Control steps at which the reader got the channel, times the scenes of the block, ended ones
    too."""
    faulted_steps: int
    """Steps with a fault in force, of scenes that were running."""
    altered_steps: int
    """Steps in which the value delivered differed from the reading, of scenes that were running."""
    missed: tuple[tuple[str, int], ...] = ()
    """Faults that name the tap and were in force at none of these deliveries, with their onset."""


def added(counts: Iterable[TapCount]) -> tuple[TapCount, ...]:
    """Return the sums tap by tap, in order of first appearance."""
    sums: dict[tuple[str, str], TapCount] = {}
    for count in counts:
        tap = count.channel, count.reader
        before = sums.get(tap, TapCount(*tap, 0, 0, 0, count.missed))
        sums[tap] = TapCount(
            *tap,
            before.deliveries + count.deliveries,
            before.faulted_steps + count.faulted_steps,
            before.altered_steps + count.altered_steps,
            tuple(fault for fault in before.missed if fault in count.missed),
        )
    return tuple(sums.values())


def check_reached(counts: Iterable[TapCount], last_steps: Sequence[int]) -> None:
    """Check that each fault was in force at a delivery of every tap that it names.

    `counts` are those of all scenes of a treatment, because a scene may read at other steps than
    those beside it; `last_steps` are the last control steps at which these ran. Raises
    `NotDelivered` where a fault missed all of them although one ran past the onset.
    """
    for tap in counts:
        for fault, onset_step in tap.missed:
            if past_onset := sum(step >= onset_step for step in last_steps):
                raise NotDelivered(
                    f"tap {tap.channel} -> {tap.reader}: '{fault}' never reached it, although "
                    f"{past_onset} of {len(last_steps)} scenes ran past the onset: "
                    f"the reader never got the channel while the fault was in force"
                )


@dataclass(frozen=True)
class FaultLog:
    """One fault at one tap."""

    fault: str
    """Description of the fault."""
    onset_step: int
    steps_in_force: NDArray[np.int64]
    """`[B]`: deliveries in its window or recovery while the scene ran."""


@dataclass(frozen=True)
class TapLog:
    """One tap over one run."""

    channel: str
    reader: str
    deliveries: int
    """Control steps at which the reader got the channel."""
    answers: int
    """Answers of a query that the reader got; 0 for a channel with one reading a step."""
    faults: tuple[FaultLog, ...]
    steps_faulted: NDArray[np.int64]
    """`[B]`: deliveries with a fault in force while the scene ran."""
    steps_altered: NDArray[np.int64]
    """`[B]`: deliveries in which the value differed from the reading while the scene ran."""


@dataclass(frozen=True)
class DeliveryLog:
    """All taps over one run."""

    scenes: tuple[str, ...]
    taps: tuple[TapLog, ...]
    steps_faulted: NDArray[np.int64]
    """`[B]`: control steps with a fault in force at one or more taps that delivered."""
    steps_altered: NDArray[np.int64]
    """`[B]`: control steps at which one or more readers got something other than the reading."""

    def counts(self) -> tuple[TapCount, ...]:
        """Return each tap's counts, summed over the scenes."""
        return tuple(
            TapCount(
                tap.channel,
                tap.reader,
                tap.deliveries * len(self.scenes),
                int(tap.steps_faulted.sum()),
                int(tap.steps_altered.sum()),
                tuple((f.fault, f.onset_step) for f in tap.faults if not f.steps_in_force.any()),
            )
            for tap in self.taps
        )

    def at(self, channel: str, reader: str) -> TapLog:
        """Return the log of one tap; `UndeclaredReader` where there is none."""
        for tap in self.taps:
            if (tap.channel, tap.reader) == (channel, reader):
                return tap
        raise UndeclaredReader(f"there is no tap {channel} -> {reader} in this variant")

    def check(self, named: Mapping[tuple[str, str], Sequence[str]]) -> None:
        """Check that faults are at the taps they name, and nowhere else.

        Args:
            named: Descriptions of the faults that name a tap, by channel and reader. They are taken
                from the faults and not from the taps, whose wiring is what is checked.

        Raises:
            NotDelivered: A fault is not at a tap that it names.
            FaultedElsewhere: A tap altered a reading that no fault names.
        """
        for tap in self.taps:
            label = f"tap {tap.channel} -> {tap.reader}"
            expected = Counter(named.get((tap.channel, tap.reader), ()))
            acting = Counter(log.fault for log in tap.faults)
            altered = tap.steps_faulted.any() or tap.steps_altered.any()
            if acting - expected or (altered and not expected):
                raise FaultedElsewhere(f"{label} altered a reading, but no fault names it")
            if missing := expected - acting:
                raise NotDelivered(f"{label}: '{min(missing)}' names it, but did not act there")
