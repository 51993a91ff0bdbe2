"""A trace as a table, and as the drawing of the interface with what really ran."""

from collections.abc import Iterable
from dataclasses import dataclass

from faultpath.interface import Channel, Interface
from faultpath.report.interface_drawing import draw_interface
from faultpath.report.interface_wiring import StruckPath
from faultpath.review.tracing import TracedRead, TraceReport
from faultpath.tables import Line, Table, line
from faultpath.trials.shown import VariantShown


@dataclass(frozen=True)
class _Marked(StruckPath):
    """Taps that something is said of."""

    @property
    def words(self) -> str:
        """What is said."""
        return self.title


def draw_trace(interface: Interface, trace: TraceReport) -> str:
    """Return the interface as SVG, with what the traced run read, from where, and the findings.

    What is declared and was not read is dashed; a reader that nobody declared is drawn as if it
    were, and marked with the number of its finding.
    """
    ran = VariantShown(
        name=trace.variant,
        consumers=tuple(sorted({read.consumer for read in trace.reads})),
        bindings={read.channel: read.source for read in trace.reads},
    )
    marks = [(each.says, each.taps) for each in trace.findings if each.taps]
    if altered := {(read.channel, read.consumer) for read in trace.reads if read.altered_by}:
        marks.append((f"altered by the fault: {trace.fault}", tuple(sorted(altered))))
    struck = [_Marked(said, frozenset(taps), frozenset(taps)) for said, taps in marks]
    return draw_interface(_as_it_ran(interface, trace), struck, (ran,))


def _as_it_ran(interface: Interface, trace: TraceReport) -> Interface:
    sources = {source.name for source in interface.sources}

    def with_readers(channel: Channel) -> Channel:
        here = [read for read in trace.reads if read.channel == channel.name]
        fed = (read.source for read in here if read.source in sources)
        return channel.model_copy(
            update={
                "consumers": _united(channel.consumers, (read.consumer for read in here)),
                "sources": _united(channel.sources, fed),
            }
        )

    return interface.model_copy(
        update={"channels": tuple(with_readers(channel) for channel in interface.channels)}
    )


def _united(declared: tuple[str, ...], seen: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys((*declared, *seen)))


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
