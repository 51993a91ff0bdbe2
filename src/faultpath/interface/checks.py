"""What must hold between the parts of an interface; each refusal says where and what to do."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from pydantic_core import PydanticCustomError

from faultpath.arrays import misfit
from faultpath.interface.words import listed, unknown

if TYPE_CHECKING:
    from faultpath.interface.model import Channel, Interface

Where = tuple[str | int, ...]


def _refuse(where: Where, sentence: str) -> PydanticCustomError:
    return PydanticCustomError("interface", "{sentence}", {"sentence": sentence, "where": where})


def check_interface(interface: "Interface") -> None:
    """Raise a pydantic error, with the path to the part in its context, unless all fits."""
    _check_unique("source", (s.name for s in interface.sources), "sources")
    _check_unique("channel", (c.name for c in interface.channels), "channels")
    _check_groups(interface)
    for index, channel in enumerate(interface.channels):
        _check_channel(interface, channel, ("channels", index))
    _check_reconstructions(interface)
    _check_cycles(interface)


def _check_unique(what: str, names: Iterable[str], *where: str | int) -> None:
    seen: set[str] = set()
    for index, name in enumerate(names):
        if name in seen:
            raise _refuse((*where, index), f"{what} '{name}' is declared twice; drop one")
        seen.add(name)


def _check_groups(interface: "Interface") -> None:
    channels = {channel.name for channel in interface.channels}
    for index, source in enumerate(interface.sources):
        if source.correlation_group in channels:
            raise _refuse(
                ("sources", index, "correlation_group"),
                f"correlation group '{source.correlation_group}' has the name of a channel; "
                "rename one, because a fault may name either",
            )


def _check_channel(interface: "Interface", channel: "Channel", where: Where) -> None:
    known = {source.name: source for source in interface.sources}
    _check_unique(f"channel '{channel.name}': source", channel.sources, *where, "sources")
    _check_unique(f"channel '{channel.name}': consumer", channel.consumers, *where, "consumers")
    for index, name in enumerate(channel.sources):
        here = (*where, "sources", index)
        if name not in known:
            raise _refuse(here, f"channel '{channel.name}': {unknown('source', name, known)}")
        source, first = known[name], known[channel.sources[0]]
        if (source.shape, source.unit) != (first.shape, first.unit):
            raise _refuse(
                here,
                f"channel '{channel.name}': source '{name}' ({list(source.shape)}, {source.unit}) "
                f"cannot stand in for '{first.name}' ({list(first.shape)}, {first.unit}); sources "
                "of one channel share shape and unit",
            )
    wrong = misfit("erasure_default", channel.erasure_default, known[channel.sources[0]].shape)
    if wrong:
        raise _refuse((*where, "erasure_default"), f"channel '{channel.name}': {wrong}")


def _check_reconstructions(interface: "Interface") -> None:
    known = {source.name: source for source in interface.sources}
    readers = {consumer.split(".")[0] for c in interface.channels for consumer in c.consumers}
    for module, name in interface.reconstructs.items():
        here = ("reconstructs", module)
        if module not in readers:
            raise _refuse(
                here,
                f"reconstructs: module '{module}' reads no channel; name its consumers in the "
                f"channels that it reads, known modules: {listed(readers)}",
            )
        if name not in known:
            raise _refuse(here, f"reconstructs: {unknown('source', name, known)}")
        if known[name].provenance != "reconstructed":
            raise _refuse(
                here,
                f"reconstructs: module '{module}' produces source '{name}', whose provenance is "
                f"{known[name].provenance}; make it reconstructed",
            )
    for index, source in enumerate(interface.sources):
        produced = source.name in interface.reconstructs.values()
        if source.provenance == "reconstructed" and not produced:
            raise _refuse(
                ("sources", index, "provenance"),
                f"source '{source.name}' is reconstructed but no module produces it; add it to "
                "reconstructs",
            )


def _check_cycles(interface: "Interface") -> None:
    from faultpath.interface.graph import feeds

    below = {module: feeds(interface, module) for module in interface.reconstructs}

    def walk(module: str, path: tuple[str, ...]) -> None:
        if module in path:
            cycle = " -> ".join((*path[path.index(module) :], module))
            raise _refuse(
                ("reconstructs", module),
                f"reconstructs: {cycle} is a cycle; a module that needs its own past keeps it in "
                "its memory instead of reading it through a channel",
            )
        for reader in below[module]:
            if reader in below:
                walk(reader, (*path, module))

    for module in below:
        walk(module, ())
