"""The interface that follows from the parts: facts from a text, readers from the ports."""

from collections.abc import Iterable
from pathlib import Path

from faultpath.interface import Interface, read_interface
from faultpath.loop.module import Module, Part


def interface_of(facts: Path | str, parts: Iterable[Part]) -> Interface:
    """Return the interface in a YAML file or text, with the readers that the parts' ports say.

    The text keeps what is fact about deployment: sources, their provenance, uncertainty, latency
    and rate, channels and what feeds them. A channel that lists consumers itself keeps its list.

    Args:
        facts: As `faultpath.interface.read_interface` takes it; channels need no consumers.
        parts: The plant and the modules of all variants, in the order in which readers are shown.

    Raises:
        UserError: The text is no interface, or nobody reads a channel of it.
    """
    consumers: dict[str, dict[str, None]] = {}
    writers: dict[str, str] = {}
    for part in parts:
        for port in sorted(part.ports):
            consumers.setdefault(port.channel, {})[f"{part.name}.{port.place}"] = None
        if isinstance(part, Module):
            writers |= dict.fromkeys(part.writes, part.name)
    return read_interface(facts, {name: tuple(found) for name, found in consumers.items()}, writers)
