"""Terminal output for a result, an interface and a trace."""

from collections.abc import Iterable
from typing import Any

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from faultpath.analyses.map.model import MapResult
from faultpath.analyses.model import AuditResult
from faultpath.analyses.scan.model import ScanResult
from faultpath.interface import Gap, Interface, rank, transitive_readers
from faultpath.report.audit_tables import DIFFERENCE, by_condition, by_quantity
from faultpath.report.secondary import chosen_metric
from faultpath.report.sentences import wording
from faultpath.report.sentences.answers import answers, would_change
from faultpath.report.sentences.phrases import (
    for_trainings,
    in_trials_that_ran,
    not_standing,
    stopping,
)
from faultpath.report.sentences.words import words
from faultpath.report.tables import Line, Table, line
from faultpath.report.tables.terminal import Parted, drawn
from faultpath.run.check.tracing import Trace, TracedRead

_EFFECTS = (*DIFFERENCE, "holm", "scenes", "void", "break-even")


def decision(record: AuditResult, details: bool = False) -> RenderableType:
    """Return the result of an audit as text and tables: headline, success, effects, findings.

    `details` adds every sentence of the record, and what would change it.
    """
    question, text = record.question, words(record)
    void = any(effect.void for effect in record.effects)
    names = [name for name in _EFFECTS if void or name != "void"]
    success = by_quantity(record, ("baseline", "repair"))
    effects = by_condition(record, names, f"{question.repair} minus {question.baseline}")
    parts: list[RenderableType] = [Text(text.headline, style="bold")]
    parts += _list("Found in the run", text.findings, "bold red")
    about: list[RenderableType] = []
    if fault := wording.faults(record.facts):
        about += [Text(f"Fault: {fault}.", style="dim")]
    if how := stopping(record):
        about += [Text(f"A sequential audit: {how}.")]
    parts += [Text(""), *about] if about and text.findings else about
    parts += [Text(""), Parted(success), Text(""), Parted(effects)]
    if any(share.result.kind in ("interval", "two pieces") for share in record.break_even):
        explained = (
            "Break-even, % of trials with the fault: the estimate where there is one, and in "
            "brackets where neither is shown to be ahead; none: one is ahead everywhere; any: no "
            "bound could be shown."
        )
        parts += [Text(explained, style="dim")]
    plain = answers(record)
    if not details and (follows := plain.get("Left open" if record.invalid else "What follows")):
        parts += [Text(""), Text(follows)]
    # Among all sentences these stand anyway.
    caveats = (*not_standing(record), *in_trials_that_ran(record), *for_trainings(record))
    for sentence in () if details else caveats:
        parts += [Text(""), Text(sentence)]
    table = chosen_metric(record)
    if table is not None:
        parts += [Text(""), Parted(table)]
    if details:
        if any(effect.mcnemar_p is not None for effect in record.effects):
            parts += [Text(""), Parted(by_condition(record, ("p", "mcnemar", "holm")))]
        parts += [Text(""), *map(Text, text.sentences)]
        parts += _list("What would change this", tuple(would_change(record)), "bold")
    return Group(*parts)


def conclusion(record: MapResult | ScanResult, tables: Iterable[Table]) -> RenderableType:
    """Return headline, sentences, findings and tables of a map or a scan."""
    text = words(record)
    parts: list[RenderableType] = [Text(text.headline, style="bold")]
    parts += _list("Found in the run", text.findings, "bold red")
    parts += [Text(""), *map(Text, text.sentences)]
    for table in tables:
        parts += [Text(""), Parted(table), *map(Text, table.notes)]
    return Group(*parts)


def _list(title: str, items: tuple[str, ...], style: str) -> list[RenderableType]:
    if not items:
        return []
    points = (Padding(Text(f"- {item}"), (0, 0, 0, 2)) for item in items)
    return [Text(""), Text(title, style=style), *points]


def interface_table(interface: Interface) -> RenderableType:
    """Return the channels of an interface, most readers first: who feeds each, who reads it and
    who is reached through a reconstruction; and what is reconstructed."""
    lines: list[Line] = []
    for channel in rank(interface):
        sources = (f"{name} {interface.source(name).provenance.value}" for name in channel.sources)
        reached = set(transitive_readers(interface, channel.name)) - set(channel.readers)
        readers = (*channel.readers, *(f"reaches {name}" for name in sorted(reached)))
        gap = "" if channel.gap is Gap.NONE else f"{channel.gap.value} gap"
        entries = ("\n".join(sources), "\n".join(readers))
        lines.append(line(channel.name, *entries, aside=gap))
    columns = ("fed by", "read by")
    table = Table(
        title=f"Information interface of {interface.name}",
        corner="channel",
        columns=columns,
        words=columns,
        lines=tuple(lines),
    )
    reconstructions = [
        Text(f"{module} reconstructs {name}.") for module, name in interface.reconstructions
    ]
    return Group(drawn(table), *reconstructions)


def trace_table(trace: Trace[Any]) -> Table:
    """Return a line for each reader of a channel, in the order in which they read."""
    taps: dict[tuple[str, str], list[TracedRead]] = {}
    for read in trace.reads:
        taps.setdefault((read.reader, read.channel), []).append(read)
    columns = ["channel", "source", "at steps", "of steps", "made by"]
    lines: list[Line] = []
    for (reader, channel), reads in taps.items():
        source = reads[0].source
        steps = (" ".join(str(r.step) for r in reads), " ".join(str(r.valid_step) for r in reads))
        entries = [channel, source, *steps, trace.reconstructed.get(source, ("",))[0]]
        if trace.fault:
            by = (name for read in reads for name in read.altered_by)
            entries.insert(1, ", ".join(dict.fromkeys(by)))
        lines.append(line(reader, *entries))
    if trace.fault:
        columns.insert(1, "altered by")
    return Table(
        title=f"{trace.variant} of {trace.system}, {trace.steps} steps in {trace.scene}",
        corner="who",
        columns=tuple(columns),
        words=tuple(columns),
        lines=tuple(lines),
        notes=(
            "At steps: those of the reading. Of steps: those at which the source got the value "
            "that was read; -1 is before the first.",
            *(
                f"{source} is reconstructed by {module} from {', '.join(channels) or 'nothing'}."
                for source, (module, channels) in trace.reconstructed.items()
            ),
        ),
    )
