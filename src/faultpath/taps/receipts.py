"""What was delivered to whom, when, and altered or not."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from faultpath.taps.counts import TapCount
from faultpath.taps.errors import NotDelivered, StruckElsewhere, UndeclaredReader


@dataclass(frozen=True)
class StrikeReceipt:
    """One fault at one tap."""

    fault: str
    """The fault in words."""
    onset_step: NDArray[np.int64]
    """`[B]`"""
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
    first_step: int | None
    last_step: int | None
    strikes: tuple[StrikeReceipt, ...]
    steps_struck: NDArray[np.int64]
    """`[B]`: deliveries with a fault in force while the scene ran."""
    steps_altered: NDArray[np.int64]
    """`[B]`: those in which the value differed from the reading."""


@dataclass(frozen=True)
class Missed:
    """Scenes in which a fault never came to bear at a tap, though it did or could elsewhere."""

    channel: str
    consumer: str
    fault: str
    ended_before: tuple[str, ...]
    """Scenes that ended before the onset."""
    not_called: tuple[str, ...]
    """Scenes that ran past the onset without a delivery in the window."""


@dataclass(frozen=True)
class Receipts:
    """All taps over one run."""

    scenes: tuple[str, ...]
    taps: tuple[Receipt, ...]
    absent: tuple[tuple[str, str], ...]
    """`(channel, consumer)` that faults name and this variant does not have."""
    steps_struck: NDArray[np.int64]
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
                int(tap.steps_struck.sum()),
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
    struck: frozenset[tuple[str, str]],
    last_step: NDArray[np.int64],
) -> tuple[Missed, ...]:
    """Compare receipts with the taps `(channel, consumer)` that the faults name.

    `last_step` `[B]` is the last control step at which each scene ran. Returns, per fault and tap,
    the scenes that it missed. Raises `NotDelivered` where it missed every scene although one ran
    past the onset, and `StruckElsewhere` where another tap altered a reading.
    """
    missed: list[Missed] = []
    for receipt in receipts.taps:
        tap = f"{receipt.channel} -> {receipt.consumer}"
        if (receipt.channel, receipt.consumer) not in struck:
            if receipt.strikes or receipt.steps_struck.any() or receipt.steps_altered.any():
                raise StruckElsewhere(f"tap {tap} altered a reading, but no fault names it")
            continue
        if not receipt.strikes:
            raise NotDelivered(f"tap {tap}: a fault names it, but none acted there")
        for strike in receipt.strikes:
            ran = last_step >= strike.onset_step
            reached = strike.steps_in_force > 0
            if ran.any() and not reached.any():
                raise NotDelivered(
                    f"tap {tap}: '{strike.fault}' never reached it, although "
                    f"{int(ran.sum())} of {len(receipts.scenes)} scenes ran past the onset; the "
                    f"consumer got the channel in {receipt.deliveries} steps"
                )
            if not reached.all():
                missed.append(
                    Missed(
                        receipt.channel,
                        receipt.consumer,
                        strike.fault,
                        ended_before=_where(receipts.scenes, ~ran & ~reached),
                        not_called=_where(receipts.scenes, ran & ~reached),
                    )
                )
    return tuple(missed)


def _where(scenes: tuple[str, ...], mask: NDArray[np.bool_]) -> tuple[str, ...]:
    return tuple(scene for scene, held in zip(scenes, mask, strict=True) if held)
