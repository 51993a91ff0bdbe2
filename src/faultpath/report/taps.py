"""The taps that a fault concerns, and where receipts show it in force, as a table."""

from faultpath.interface import Channel, module_of
from faultpath.record.model import DecisionRecord, Path
from faultpath.report.inputs import ReportInput
from faultpath.tables import Entry, Line, Table, line
from faultpath.trials import VariantShown

Tap = tuple[str, str]
"""A channel and the consumer that reads it."""


def struck_taps(path: Path) -> tuple[frozenset[Tap], frozenset[Tap]]:
    """Return the taps at which the fault was in force, in the baseline and in the repair."""
    baseline, repair = (
        frozenset((tap.channel, tap.consumer) for tap in struck)
        for struck in (path.baseline_struck, path.struck)
    )
    return baseline, repair


def tap_table(source: ReportInput) -> Table:
    """Return the taps of the channels that the fault is on and of those that the faulted modules
    reconstruct: what feeds each channel, and at which taps the fault was in force on which path."""
    record, interface = source.record, source.interface
    struck = {tap for path in record.paths for side in struck_taps(path) for tap in side}
    wanted = {channel for channel, _ in struck} | {f.channel for f in record.question.faults}
    faulted = {module_of(consumer) for _, consumer in struck}
    made = {name for module, name in interface.reconstructions if module in faulted}
    lines: list[Line] = []
    for channel in interface.channels:
        fed = [_feeds(channel, variant) for variant in source.variants]
        if channel.name not in wanted and made.isdisjoint(fed):
            continue
        lines.append(line(f"{channel.name}, fed by {' or '.join(dict.fromkeys(fed))}"))
        lines += [
            line(consumer, *_entries(record, source.variants, (channel.name, consumer)), name=True)
            for consumer in channel.consumers
            if any(consumer in variant.consumers for variant in source.variants)
        ]
    asked = record.question
    columns = (f"baseline {asked.baseline}", f"repair {asked.repair}")
    return Table(
        title="Taps at which receipts show the fault in force",
        corner="Tap",
        columns=columns,
        words=columns,
        lines=tuple(lines),
    )


def _feeds(channel: Channel, variant: VariantShown) -> str:
    return variant.bindings.get(channel.name, channel.sources[0])


def _entries(record: DecisionRecord, variants: tuple[VariantShown, ...], tap: Tap) -> list[Entry]:
    entries: list[Entry] = []
    for side, variant in enumerate(variants):
        on = [path.title for path in record.paths if tap in struck_taps(path)[side]]
        if on:
            entries.append(Entry(text=f"faulted: {', '.join(on)}", tone="bad"))
        elif tap[1] in variant.consumers:
            entries.append(Entry(text="correct"))
        elif module_of(tap[1]) in map(module_of, variant.consumers):
            entries.append(Entry(text="not read", tone="faint"))
        else:
            entries.append(Entry(text="no such module", tone="faint"))
    return entries
