"""What the command line prints of a decision record and of an interface."""

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from faultpath.decisions.model import DecisionRecord
from faultpath.decisions.summary import not_standing
from faultpath.decisions.tables import Line, Table, line
from faultpath.decisions.tables.terminal import Parted, drawn
from faultpath.interface import Channel, Gap, Interface, rank, transitive_consumers
from faultpath.report.tables import DIFFERENCE, by_path, by_quantity, by_threshold

_EFFECTS = (*DIFFERENCE, "holm", "scenes", "void", "break-even")


def decision(record: DecisionRecord, details: bool = False) -> RenderableType:
    """Return the decision record as text and tables: verdict, success, effects, findings.

    `details` adds every sentence of the record, and what would change it.
    """
    asked = record.question
    void = any(effect.void_pairs for effect in record.effects)
    names = [name for name in _EFFECTS if void or name != "void"]
    success = by_quantity(record, ("baseline", "repair"))
    effects = by_path(record, names, f"{asked.repair} minus {asked.baseline}")
    parts: list[RenderableType] = [Text(record.verdict.headline, style="bold")]
    if record.stopping:
        parts += [Text(f"A sequential audit: {record.stopping}.")]
    parts += [Text(""), Parted(success), Text(""), Parted(effects)]
    for said in not_standing(record):
        parts += [Text(""), Text(said)]
    told = by_threshold(record)
    if told is not None:
        parts += [Text(""), drawn(told)]
    parts += _list("Found in the run", record.findings, "bold red")
    if details:
        if record.question.ruled:
            parts += [Text(""), Text(f"Rule: {record.question.ruled}.")]
        if any(effect.mcnemar_p_value is not None for effect in record.effects):
            parts += [Text(""), Parted(by_path(record, ("p", "mcnemar", "holm")))]
        parts += [Text(""), *map(Text, record.verdict.sentences)]
        parts += _list("What would change this", record.verdict.would_change, "bold")
    return Group(*parts)


def _list(title: str, items: tuple[str, ...], style: str) -> list[RenderableType]:
    if not items:
        return []
    points = (Padding(Text(f"- {item}"), (0, 0, 0, 2)) for item in items)
    return [Text(""), Text(title, style=style), *points]


def interface_table(interface: Interface) -> RenderableType:
    """Return the channels of an interface, most consumers first, and what is reconstructed."""
    columns = ("fed by", "read by")
    table = Table(
        title=f"Information interface of {interface.name}",
        corner="channel",
        columns=columns,
        words=columns,
        lines=tuple(_line(interface, channel) for channel in rank(interface)),
    )
    made = [Text(f"{module} reconstructs {name}.") for module, name in interface.reconstructions]
    return Group(drawn(table), *made)


def _line(interface: Interface, channel: Channel) -> Line:
    """Who feeds a channel, who reads it, and who is reached through a reconstruction."""
    sources = (f"{name} {interface.source(name).provenance.value}" for name in channel.sources)
    further = sorted(set(transitive_consumers(interface, channel.name)) - set(channel.consumers))
    consumers = (*channel.consumers, *(f"reaches {name}" for name in further))
    gap = "no" if channel.gap is Gap.NONE else channel.gap.value
    return line(channel.name, "\n".join(sources), "\n".join(consumers), aside=f"{gap} gap")
