"""One consumer's end of one channel, and how a variant's taps come about."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from faultpath.core.arrays import Array
from faultpath.core.errors import UserError
from faultpath.core.text import unknown
from faultpath.interface import Interface, Provenance
from faultpath.loop.taps.guard import Guard
from faultpath.loop.taps.receipts import Receipt, StrikeReceipt
from faultpath.loop.taps.strike import Strike
from faultpath.loop.taps.tally import Tally


@dataclass(slots=True, eq=False)
class Tap:
    """One consumer's end of one channel."""

    channel: str
    consumer: str
    source: str
    legal: bool
    shape: tuple[int, ...]
    """Of every reading, scenes first."""
    strikes: tuple[Strike, ...] = ()
    deliveries: int = 0
    asks: int = 0
    """Answers of a query, over all steps."""
    asked: int = 0
    """Those of the last step."""
    last_step: int = -1
    given: Array = None
    """The value of the step's reading."""
    cached: Array = None
    """What the consumer got of it."""
    finite: Array = None
    """Where the first reading was finite, until that has been looked at."""
    guard: Guard | None = None
    struck: Tally = field(default_factory=Tally)
    altered: Tally = field(default_factory=Tally)

    def __str__(self) -> str:
        return f"{self.channel} -> {self.consumer}"

    def add(self, strike: Strike) -> None:
        """Let a fault strike here; a fault that is alone counts for the whole tap."""
        self.strikes = (*self.strikes, strike)
        self.struck = strike.in_force if len(self.strikes) == 1 else Tally()

    def receipt(self, n_scenes: int) -> Receipt:
        """Return what passed here so far; this waits for the device that holds the counts."""
        return Receipt(
            channel=self.channel,
            consumer=self.consumer,
            source=self.source,
            deliveries=self.deliveries,
            asks=self.asks,
            strikes=tuple(
                StrikeReceipt(
                    fault=strike.fault.describe(),
                    onset_step=strike.onsets(n_scenes),
                    steps_in_force=strike.in_force.counts(n_scenes),
                )
                for strike in self.strikes
            ),
            steps_struck=self.struck.counts(n_scenes),
            steps_altered=self.altered.counts(n_scenes),
        )


def wire(
    interface: Interface,
    bindings: Mapping[str, str],
    consumers: Collection[str] | None,
    privileged: Collection[str],
    n_scenes: int,
) -> dict[tuple[str, str], Tap]:
    """Return the taps of a variant by channel and consumer; raises `UserError` for wrong names."""
    for name in bindings:
        interface.channel(name)
    for name in privileged:
        interface.source(name)
    declared = {name for channel in interface.channels for name in channel.consumers}
    for name in consumers or ():
        if name not in declared:
            raise UserError(f"this variant's consumers: {unknown('consumer', name, declared)}")
    taps: dict[tuple[str, str], Tap] = {}
    for channel in interface.channels:
        bound = bindings.get(channel.name, channel.sources[0])
        if bound not in channel.sources:
            said = unknown("source", bound, channel.sources)
            raise UserError(f"channel '{channel.name}' cannot be bound: {said}")
        source = interface.source(bound)
        secret = source.provenance is Provenance.PRIVILEGED
        shape = (n_scenes, *source.shape)
        for name in channel.consumers:
            if consumers is None or name in consumers:
                legal = bound in privileged or not secret
                taps[channel.name, name] = Tap(channel.name, name, bound, legal, shape)
    return taps
