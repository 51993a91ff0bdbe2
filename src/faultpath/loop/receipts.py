"""Receipts of deliveries: to whom, when, and altered or not."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faultpath.core.arrays import Array, copy, differs, namespace, to_numpy, together
from faultpath.loop.reading import FaultedElsewhere, NotDelivered, UndeclaredReader


class Tally:
    """Steps at which something held in a scene.

    Counts stay on the device of the masks, so that counting costs no host wait. Several taps may
    report the same step; it counts once.
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
    """Hands out copies of a tap's values and sees whether somebody wrote into them.

    NumPy arrays are read-only views and need none of this. Any other is compared with what it was.
    """

    __slots__ = ("_kept", "_lent", "_written")

    def __init__(self) -> None:
        self._lent: Array = None
        self._kept: Array = None
        self._written: Any = False

    def hand_out(self, value: Array) -> Array:
        """Return a copy for the reader, after a look at the last one."""
        self._look()
        self._lent, self._kept = copy(value), copy(value)
        return self._lent

    def written(self) -> bool:
        """Return whether a reader wrote; this waits for the device."""
        self._look()
        return bool(to_numpy(self._written))

    def _look(self) -> None:
        if self._lent is not None:
            unequal = differs(self._lent, self._kept)
            self._written = self._written | namespace(unequal).any(unequal)


@dataclass(frozen=True, slots=True)
class TapCount:
    """Counts of one tap, summed over scenes."""

    channel: str
    reader: str
    deliveries: int
    """Control steps at which the reader got the channel, once for each scene of the block, also
    for scenes that have ended."""
    faulted_steps: int
    """Those with a fault in force; scenes that have ended do not count."""
    altered_steps: int
    """Those in which the value delivered differed from the reading; likewise."""


def added(counts: Iterable[TapCount]) -> tuple[TapCount, ...]:
    """Return one count a tap, in the order in which the taps come up first."""
    sums: dict[tuple[str, str], tuple[int, int, int]] = {}
    for count in counts:
        before = sums.get((count.channel, count.reader), (0, 0, 0))
        sums[count.channel, count.reader] = (
            before[0] + count.deliveries,
            before[1] + count.faulted_steps,
            before[2] + count.altered_steps,
        )
    return tuple(TapCount(*tap, *numbers) for tap, numbers in sums.items())


@dataclass(frozen=True)
class CorruptionReceipt:
    """One fault at one tap."""

    fault: str
    """The fault in words."""
    onset_step: int
    steps_in_force: NDArray[np.int64]
    """`[B]`: deliveries in the window, or in recovery after it, while the scene ran."""


@dataclass(frozen=True)
class Receipt:
    """One tap over one run."""

    channel: str
    reader: str
    deliveries: int
    """Control steps at which the reader got the channel."""
    asks: int
    """Answers that it got of a query; 0 for a channel with one reading a step."""
    corruptions: tuple[CorruptionReceipt, ...]
    steps_faulted: NDArray[np.int64]
    """`[B]`: deliveries with a fault in force while the scene ran."""
    steps_altered: NDArray[np.int64]
    """`[B]`: those in which the value differed from the reading."""


@dataclass(frozen=True)
class Receipts:
    """All taps over one run."""

    scenes: tuple[str, ...]
    taps: tuple[Receipt, ...]
    steps_faulted: NDArray[np.int64]
    """`[B]`: control steps with a fault in force at some tap that delivered."""
    steps_altered: NDArray[np.int64]
    """`[B]`: control steps at which some reader got something else than the reading."""

    def counts(self) -> tuple[TapCount, ...]:
        """Return what every tap did, summed over the scenes."""
        return tuple(
            TapCount(
                tap.channel,
                tap.reader,
                tap.deliveries * len(self.scenes),
                int(tap.steps_faulted.sum()),
                int(tap.steps_altered.sum()),
            )
            for tap in self.taps
        )

    def at(self, channel: str, reader: str) -> Receipt:
        """Return the receipt of one tap; raises `UndeclaredReader` where there is no such tap."""
        for receipt in self.taps:
            if (receipt.channel, receipt.reader) == (channel, reader):
                return receipt
        raise UndeclaredReader(f"there is no tap {channel} -> {reader} in this variant")


def check_delivered(
    receipts: Receipts,
    named: Mapping[tuple[str, str], Sequence[str]],
    last_step: NDArray[np.int64],
) -> None:
    """Compare receipts with the faults.

    `named` holds, by channel and reader, the words of the faults that name this tap: taken from
    the faults, not from the taps. `last_step` `[B]` is the last control step at which each scene
    ran. Raises `NotDelivered` where a fault missed every scene of a tap although one ran past the
    onset, and `FaultedElsewhere` where another tap altered a reading.
    """
    for receipt in receipts.taps:
        tap = f"{receipt.channel} -> {receipt.reader}"
        expected = Counter(named.get((receipt.channel, receipt.reader), ()))
        acting = Counter(corruption.fault for corruption in receipt.corruptions)
        altered = receipt.steps_faulted.any() or receipt.steps_altered.any()
        if acting - expected or (altered and not expected):
            raise FaultedElsewhere(f"tap {tap} altered a reading, but no fault names it")
        if missing := expected - acting:
            raise NotDelivered(f"tap {tap}: '{min(missing)}' names it, but did not act there")
        for one in receipt.corruptions:
            ran = last_step >= one.onset_step
            if ran.any() and not one.steps_in_force.any():
                raise NotDelivered(
                    f"tap {tap}: '{one.fault}' never reached it, although "
                    f"{int(ran.sum())} of {len(receipts.scenes)} scenes ran past the onset; the "
                    f"reader got the channel in {receipt.deliveries} steps"
                )
