"""An information interface as a table on the terminal."""

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from faultpath.interface import Interface, rank, transitive_consumers


def interface_table(interface: Interface) -> RenderableType:
    """Return the channels of an interface, most consumers first, and what is reconstructed."""
    table = Table(
        title=Text(f"Information interface of {interface.name}"),
        title_justify="left",
        box=None,
        pad_edge=False,
        padding=(0, 2, 0, 0),
    )
    for head in ("channel", "gap", "fed by", "read by", "reaches"):
        table.add_column(head)
    for ranked in rank(interface):
        channel = interface.channel(ranked.channel)
        further = set(transitive_consumers(interface, channel.name)) - set(channel.consumers)
        sources = [
            f"{name} ({interface.source(name).provenance.value})" for name in channel.sources
        ]
        table.add_row(
            Text(channel.name, style="bold"),
            Text(channel.gap.value),
            Text("\n".join(sources)),
            Text("\n".join(channel.consumers)),
            Text("\n".join(sorted(further))),
        )
    made = [
        Text(f"{module} reconstructs {source}.")
        for module, source in interface.reconstructs.items()
    ]
    reach = "Reaches: consumers that a fault gets to through a reconstruction."
    return Group(table, Text(""), Text(reach, style="dim"), *made)
