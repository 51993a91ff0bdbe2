"""The part of an interface that a fault concerns, and its taps in words for a narrow screen."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from faultpath.interface import Channel, Interface, module_of
from faultpath.report.interface_layout import Tap
from faultpath.report.interface_wiring import StruckPath, Who, Wiring


def concerned(
    interface: Interface, struck: Sequence[StruckPath], channels: Iterable[str], wiring: Wiring
) -> Interface | None:
    """Return the channels that a fault is on, and those fed by what the struck modules make.

    Of their sources those remain that feed one of the variants. `None` where no channel is meant or
    struck, and where nothing would be left out.
    """
    taps = {tap for path in struck for tap in path.taps}
    wanted = {channel for channel, _ in taps} | set(channels)
    at = {module_of(consumer) for _, consumer in taps}
    made = {source for module, source in interface.reconstructions if module in at}
    kept: list[Channel] = []
    for channel in interface.channels:
        fed = tuple(s for s in channel.sources if wiring.feeds(channel, s) is not Who.NEITHER)
        if channel.name in wanted or made & set(fed):
            kept.append(channel.model_copy(update={"sources": fed or channel.sources}))
    if not wanted or len(kept) == len(interface.channels):
        return None
    names = {source for channel in kept for source in channel.sources}
    readers = {module_of(consumer) for channel in kept for consumer in channel.consumers}
    return interface.model_copy(
        update={
            "channels": tuple(kept),
            "sources": tuple(each for each in interface.sources if each.name in names),
            "reconstructs": {
                module: tuple(source for source in sources if source in names)
                for module, sources in interface.reconstructs.items()
                if module in readers
            },
        }
    )


@dataclass(frozen=True)
class TapRow:
    """A tap, and what happened there in baseline and repair."""

    consumer: str
    said: tuple[str, str]
    struck: tuple[bool, bool]
    absent: tuple[bool, bool]


@dataclass(frozen=True)
class ChannelRows:
    """A channel, what feeds it, and its taps."""

    name: str
    fed: str
    taps: tuple[TapRow, ...]


def tap_rows(
    interface: Interface, struck: Sequence[StruckPath], wiring: Wiring
) -> list[ChannelRows]:
    """Return every tap in words, channel by channel, for the two variants of an audit."""
    return [
        ChannelRows(
            channel.name,
            ", ".join(
                f"{source}{wiring.words(by)}"
                for source in channel.sources
                if (by := wiring.feeds(channel, source)) is not Who.NEITHER
            )
            or "nothing",
            tuple(_row((channel.name, consumer), struck, wiring) for consumer in channel.consumers),
        )
        for channel in interface.channels
    ]


def _row(tap: Tap, struck: Sequence[StruckPath], wiring: Wiring) -> TapRow:
    numbers = [
        [str(n) for n, taps in enumerate(side, 1) if tap in taps]
        for side in ([path.baseline for path in struck], [path.repair for path in struck])
    ]
    lacks = wiring.lacking(tap)
    said = [
        f"struck on {', '.join(n)}" if n else why or "reads"
        for n, why in zip(numbers, lacks, strict=True)
    ]
    hit = [bool(each) for each in numbers]
    return TapRow(tap[1], (said[0], said[1]), (hit[0], hit[1]), (bool(lacks[0]), bool(lacks[1])))
