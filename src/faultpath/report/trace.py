"""A trace as a table."""

from collections.abc import Iterable

from faultpath.decisions.tables import Line, Table, line
from faultpath.systems.checks.tracing import TracedRead, TraceReport


def trace_table(trace: TraceReport) -> Table:
    """Return a line for each consumer of a channel, in the order in which they read."""
    taps: dict[tuple[str, str], list[TracedRead]] = {}
    for read in trace.reads:
        taps.setdefault((read.consumer, read.channel), []).append(read)
    columns = ("channel", "source", "at steps", "of steps", "made by")
    if trace.fault:
        columns = ("channel", "altered by", *columns[1:])
    return Table(
        title=f"{trace.variant} of {trace.system}, {trace.steps} steps in {trace.scene}",
        corner="who",
        columns=columns,
        words=columns,
        lines=_lines(trace, taps.values()),
        notes=tuple(
            f"{source} is reconstructed by {module} from {', '.join(channels) or 'nothing'}."
            for source, (module, channels) in trace.reconstructed.items()
        ),
    )


def _lines(trace: TraceReport, taps: Iterable[list[TracedRead]]) -> tuple[Line, ...]:
    lines: list[Line] = []
    for reads in taps:
        first = reads[0]
        entries = [
            first.channel,
            first.source,
            " ".join(str(read.step) for read in reads),
            " ".join(str(read.valid_step) for read in reads),
            trace.reconstructed.get(first.source, ("",))[0],
        ]
        if trace.fault:
            said = ", ".join(dict.fromkeys(w for read in reads for w in read.altered_by))
            entries.insert(1, said)
        lines.append(line(first.consumer, *entries))
    return tuple(lines)
