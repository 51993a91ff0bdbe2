"""What passed through a tap, in whole numbers that add up over blocks and seeds."""

from collections.abc import Iterable
from dataclasses import dataclass


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
