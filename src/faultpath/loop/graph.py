"""The executable graph of parts, and the interface that follows from their ports."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from faultpath.core.errors import SystemMistake
from faultpath.core.text import listed
from faultpath.interface import Interface, read_interface
from faultpath.loop.parts import Graph, Module, Part, Plant, label_of


def graph(
    interface: Interface,
    plant: Plant,
    modules: Sequence[Module],
    bindings: Mapping[str, str] | None = None,
) -> Graph:
    """Return the graph of a plant and modules.

    Args:
        interface: Declares the channels, their sources and their readers.
        plant: The part that senses and is moved.
        modules: In any order.
        bindings: Channel to source, where it is not the channel's first source.

    Raises:
        SystemMistake: A port or a source is not declared, a source has two writers or none, or
            modules wait for each other.
    """
    bound = {channel.name: channel.sources[0] for channel in interface.channels}
    bound |= dict(bindings or {})
    writers: dict[str, Module | Plant] = {}
    for part, names in [(plant, plant.senses), *((module, module.writes) for module in modules)]:
        for name in names:
            interface.source(name)
            if name in writers:
                raise SystemMistake(
                    f"source '{name}' is written by '{writers[name].name}' and by '{part.name}': "
                    "give each source one writer"
                )
            writers[name] = part
    for part in (*modules, plant):
        _check_ports(interface, part, bound, writers)
        missing = sorted(set(part.truths) - set(plant.shows)) if isinstance(part, Module) else []
        if missing:
            raise SystemMistake(
                f"module '{part.name}' declares the truth '{missing[0]}', which the plant does not "
                f"show: it shows {listed(plant.shows)}"
            )
    return Graph(plant, _ordered(modules, bound, writers), bound)


def _check_ports(
    interface: Interface, part: Part, bound: Mapping[str, str], writers: Mapping[str, object]
) -> None:
    twice = part.reads & part.reads_past
    if twice:
        port = min(twice)
        raise SystemMistake(
            f"{label_of(part)} reads channel '{port.channel}' at '{port.place}' both now and "
            "one step before: keep one of the two, or give them two places"
        )
    for port in sorted(part.ports):
        reader = part.reader(port)
        declared = interface.channel(port.channel).readers
        if reader not in declared:
            raise SystemMistake(
                f"{label_of(part)} reads channel '{port.channel}' at '{port.place}', but the "
                f"interface does not list {reader} among its readers: {listed(declared)}"
            )
        if bound[port.channel] not in writers:
            raise SystemMistake(
                f"channel '{port.channel}' is bound to source '{bound[port.channel]}', which "
                "neither the plant nor a module writes here"
            )


def _ordered(
    modules: Sequence[Module], bound: Mapping[str, str], writers: Mapping[str, Module | Plant]
) -> tuple[Module, ...]:
    # By identity, since parts may share a name.
    needed = {
        id(module): {id(writers[bound[port.channel]]) for port in module.reads}
        for module in modules
    }
    ordered: list[Module] = []
    waiting = list(modules)
    while waiting:
        pending = {id(module) for module in waiting}
        ready = next((module for module in waiting if pending.isdisjoint(needed[id(module)])), None)
        if ready is None:
            names = " -> ".join(dict.fromkeys(module.name for module in waiting))
            raise SystemMistake(
                f"modules wait for each other within one step: {names}; let one of them read what "
                "its channel held one step before: by `past=` of @writes, or in reads_past"
            )
        ordered.append(ready)
        waiting.remove(ready)
    return tuple(ordered)


def interface_of(facts: Path | str | Mapping[str, Any], parts: Iterable[Part]) -> Interface:
    """Return the interface that facts about deployment and the ports of parts make together.

    The facts are sources, their provenance, uncertainty, latency and rate, and channels with their
    sources. Readers and reconstructions follow from the parts.

    Args:
        facts: As `faultpath.interface.read_interface` takes it; channels need no readers.
        parts: The plant and the modules of all variants, in the order in which readers are shown.

    Raises:
        UserError: The facts are no interface, or one of its channels has no reader.
    """
    readers: dict[str, dict[str, None]] = {}
    writers: dict[str, dict[str, None]] = {}
    for part in parts:
        for port in sorted(part.ports):
            readers.setdefault(port.channel, {})[part.reader(port)] = None
        for source in part.writes if part.ports else ():
            writers.setdefault(source, {})[part.name] = None
    return read_interface(
        facts,
        {channel: tuple(names) for channel, names in readers.items()},
        {source: tuple(names) for source, names in writers.items()},
    )
