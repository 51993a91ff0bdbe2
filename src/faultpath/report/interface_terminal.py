"""An information interface as a table on the terminal."""

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from faultpath.interface import Gap, Interface, rank, transitive_consumers


def interface_table(interface: Interface) -> RenderableType:
    """Return the channels of an interface, most consumers first, and what is reconstructed.

    Fits a terminal of 80 columns: what qualifies a name stands below it.
    """
    table = Table(
        title=Text(f"Information interface of {interface.name}"),
        title_justify="left",
        box=None,
        pad_edge=False,
        padding=(0, 2, 1, 0),
    )
    for head in ("channel", "fed by", "read by"):
        table.add_column(head, overflow="fold")
    for ranked in rank(interface):
        channel = interface.channel(ranked.channel)
        name = Text(channel.name, style="bold")
        gap = "no" if channel.gap is Gap.NONE else channel.gap.value
        name.append(f"\n{gap} gap", style="not bold dim")
        table.add_row(
            name, _sources(interface, channel.sources), _consumers(interface, channel.name)
        )
    made = [
        Text(f"{module} reconstructs {source}.")
        for module, source in interface.reconstructs.items()
    ]
    return Group(table, *made)


def _sources(interface: Interface, names: tuple[str, ...]) -> Text:
    lines = [Text(f"{name} ").append(_provenance(interface, name)) for name in names]
    return Text("\n").join(lines)


def _provenance(interface: Interface, name: str) -> Text:
    return Text(interface.source(name).provenance.value, style="dim")


def _consumers(interface: Interface, channel: str) -> Text:
    """Who reads the channel, then who is reached through a reconstruction."""
    direct = interface.channel(channel).consumers
    further = sorted(set(transitive_consumers(interface, channel)) - set(direct))
    lines = [Text(name) for name in direct]
    lines += [Text(f"reaches {name}", style="dim") for name in further]
    return Text("\n").join(lines)
