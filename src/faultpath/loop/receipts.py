"""What was delivered to whom, when, and altered or not."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from faultpath.loop.reading import FaultedElsewhere, NotDelivered, UndeclaredReader


@dataclass(frozen=True, slots=True)
class TapCount:
    """What one tap did, summed over scenes."""

    channel: str
    consumer: str
    deliveries: int
    """Control steps at which the consumer got the channel, once a scene of the block."""
    struck_steps: int
    """Those with a fault in force while the scene ran."""
    altered_steps: int
    """Those in which what was delivered differed from the reading."""


def added(counts: Iterable[TapCount]) -> tuple[TapCount, ...]:
    """Return one count a tap, in the order in which the taps come up first."""
    sums: dict[tuple[str, str], tuple[int, int, int]] = {}
    for each in counts:
        before = sums.get((each.channel, each.consumer), (0, 0, 0))
        sums[each.channel, each.consumer] = (
            before[0] + each.deliveries,
            before[1] + each.struck_steps,
            before[2] + each.altered_steps,
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
    consumer: str
    source: str
    deliveries: int
    """Control steps at which the consumer got the channel."""
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
    """`[B]`: control steps at which some consumer got something else than the reading."""

    def counts(self) -> tuple[TapCount, ...]:
        """Return what every tap did, summed over the scenes."""
        return tuple(
            TapCount(
                tap.channel,
                tap.consumer,
                tap.deliveries * len(self.scenes),
                int(tap.steps_faulted.sum()),
                int(tap.steps_altered.sum()),
            )
            for tap in self.taps
        )

    def at(self, channel: str, consumer: str) -> Receipt:
        """Return the receipt of one tap; raises `UndeclaredReader` where there is no such tap."""
        for receipt in self.taps:
            if (receipt.channel, receipt.consumer) == (channel, consumer):
                return receipt
        raise UndeclaredReader(f"there is no tap {channel} -> {consumer} in this variant")


def check_delivered(
    receipts: Receipts,
    faulted: frozenset[tuple[str, str]],
    last_step: NDArray[np.int64],
) -> None:
    """Compare receipts with the taps `(channel, consumer)` that the faults name.

    `last_step` `[B]` is the last control step at which each scene ran. Raises `NotDelivered` where
    a fault missed every scene of a tap although one ran past the onset, and `FaultedElsewhere`
    where another tap altered a reading.
    """
    for receipt in receipts.taps:
        tap = f"{receipt.channel} -> {receipt.consumer}"
        if (receipt.channel, receipt.consumer) not in faulted:
            if receipt.corruptions or receipt.steps_faulted.any() or receipt.steps_altered.any():
                raise FaultedElsewhere(f"tap {tap} altered a reading, but no fault names it")
            continue
        if not receipt.corruptions:
            raise NotDelivered(f"tap {tap}: a fault names it, but none acted there")
        for one in receipt.corruptions:
            ran = last_step >= one.onset_step
            if ran.any() and not one.steps_in_force.any():
                raise NotDelivered(
                    f"tap {tap}: '{one.fault}' never reached it, although "
                    f"{int(ran.sum())} of {len(receipts.scenes)} scenes ran past the onset; the "
                    f"consumer got the channel in {receipt.deliveries} steps"
                )
