"""What the command line prints: the decision record and an interface, as rich renderables."""

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from faultpath.interface import Interface, rank, transitive_consumers
from faultpath.record.model import DecisionRecord
from faultpath.report import wording


def success_table(record: DecisionRecord) -> Table:
    """Return success by variant and path: what each cell of the audit came to."""
    asked = record.question
    table = _table("Success, %")
    table.add_column("variant", no_wrap=False)
    for path in record.paths:
        table.add_column(Text(path.title), justify="right")
    for variant in (asked.baseline, asked.repair):
        cells = {cell.path: cell for cell in record.cells if cell.variant == variant}
        texts = [
            Text(wording.plain(cells[p.name].success_percent)) if p.name in cells else Text("–")
            for p in record.paths
        ]
        table.add_row(Text(variant), *texts)
    return table


def effect_table(record: DecisionRecord) -> Table:
    """Return the effects path by path, with what stands behind them."""
    titles = {path.name: path.title for path in record.paths}
    breaks = {b.path: wording.break_even(b.result) for b in record.break_even}
    asked = record.question
    table = _table(f"{asked.repair} minus {asked.baseline}")
    table.add_column("path")
    for head in (
        "difference, pp",
        "won:lost",
        "p",
        "detectable, pp",
        "pairs",
        "void",
        "break-even",
    ):
        table.add_column(head, justify="right")
    for effect in record.effects:
        detectable = effect.minimum_detectable_pp
        table.add_row(
            Text(titles.get(effect.path, effect.path)),
            Text(wording.with_interval(effect.success), style="bold" if effect.detected else ""),
            wording.wins_losses(effect.wins, effect.losses),
            wording.p_value(effect.p_value),
            "–" if detectable is None else wording.plain(detectable),
            str(effect.pairs),
            Text(str(effect.void_pairs), style="bold red" if effect.void_pairs else ""),
            breaks.get(effect.path, "–"),
        )
    return table


def decision(record: DecisionRecord) -> RenderableType:
    """Return the decision record as text and tables: verdict, effects, what would change it."""
    parts: list[RenderableType] = [Text(record.verdict.headline, style="bold"), Text("")]
    parts += [Text(sentence) for sentence in record.verdict.sentences]
    parts += [Text(""), success_table(record), Text(""), effect_table(record)]
    if record.verdict.would_change:
        parts += [Text(""), Text("What would change this", style="bold")]
        parts += [Padding(Text(f"- {item}"), (0, 0, 0, 2)) for item in record.verdict.would_change]
    return Group(*parts)


def interface_table(interface: Interface) -> RenderableType:
    """Return sources, channels in the order in which to audit them, and reconstructions."""
    sources = _table("Sources")
    for head in ("source", "provenance", "unit", "errors shared in"):
        sources.add_column(head)
    for source in interface.sources:
        group = source.correlation_group or ""
        sources.add_row(source.name, source.provenance.value, Text(source.unit), group)
    channels = _table("Channels, the one to audit first in front")
    for head in ("channel", "gap", "sources", "consumers"):
        channels.add_column(head, overflow="fold")
    channels.add_column("a fault reaches", justify="right")
    for ranked in rank(interface):
        channel = interface.channel(ranked.channel)
        channels.add_row(
            channel.name,
            channel.gap.value,
            ", ".join(channel.sources),
            ", ".join(channel.consumers),
            wording.counted(len(transitive_consumers(interface, channel.name)), "tap"),
        )
    parts: list[RenderableType] = [sources, Text(""), channels]
    if interface.reconstructs:
        parts.append(Text(""))
    parts += [
        Text(f"{module} reconstructs {source}: its own reads are part of that path.")
        for module, source in interface.reconstructs.items()
    ]
    return Group(*parts)


def _table(title: str) -> Table:
    return Table(
        title=Text(title), title_justify="left", box=None, pad_edge=False, padding=(0, 2, 0, 0)
    )
