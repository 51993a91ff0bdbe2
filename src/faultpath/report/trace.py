"""A trace as a table."""

from faultpath.decisions.tables import Line, Table, line
from faultpath.systems.checks.recording import Read
from faultpath.systems.checks.tracing import TraceReport


def trace_table(trace: TraceReport) -> Table:
    """Return a line for each consumer of a channel, in the order in which they read."""
    taps: dict[tuple[str, str], list[Read]] = {}
    for read in trace.reads:
        taps.setdefault((read.consumer, read.channel), []).append(read)
    columns = ["channel", "source", "at steps", "of steps", "made by"]
    lines: list[Line] = []
    for (consumer, channel), reads in taps.items():
        source = reads[0].source
        steps = (" ".join(str(r.step) for r in reads), " ".join(str(r.valid_step) for r in reads))
        entries = [channel, source, *steps, trace.reconstructed.get(source, ("",))[0]]
        if trace.fault:
            by = (name for read in reads for name in read.altered_by)
            entries.insert(1, ", ".join(dict.fromkeys(by)))
        lines.append(line(consumer, *entries))
    if trace.fault:
        columns.insert(1, "altered by")
    return Table(
        title=f"{trace.variant} of {trace.system}, {trace.steps} steps in {trace.scene}",
        corner="who",
        columns=tuple(columns),
        words=tuple(columns),
        lines=tuple(lines),
        notes=tuple(
            f"{source} is reconstructed by {module} from {', '.join(channels) or 'nothing'}."
            for source, (module, channels) in trace.reconstructed.items()
        ),
    )
