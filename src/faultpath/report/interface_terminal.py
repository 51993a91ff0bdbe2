"""An information interface as a table on the terminal."""

from rich.console import Group, RenderableType
from rich.text import Text

from faultpath.interface import Channel, Gap, Interface, rank, transitive_consumers
from faultpath.tables import Line, Table, line
from faultpath.tables.terminal import drawn


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
