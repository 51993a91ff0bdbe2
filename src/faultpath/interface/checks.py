"""An interface whose parts fit each other; each refusal says where and what to do."""

from collections.abc import Iterable, Mapping
from typing import Self

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from faultpath.core.arrays import misfit
from faultpath.core.text import listed, unknown
from faultpath.interface.graph import readers
from faultpath.interface.model import Channel, Declared, Source

Where = tuple[str | int, ...]


def _refuse(where: Where, sentence: str) -> PydanticCustomError:
    return PydanticCustomError("interface", "{sentence}", {"sentence": sentence, "where": where})


class Interface(Declared):
    """All sources and channels of a system, and which modules produce sources themselves."""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        _check_unique("source", (s.name for s in self.sources), "sources")
        _check_unique("channel", (c.name for c in self.channels), "channels")
        _check_groups(self)
        known = {source.name: source for source in self.sources}
        for index, channel in enumerate(self.channels):
            _check_channel(known, channel, ("channels", index))
        _check_reconstructions(self)
        _check_cycles(self)
        return self


def _check_unique(what: str, names: Iterable[str], *where: str | int) -> None:
    seen: set[str] = set()
    for index, name in enumerate(names):
        if name in seen:
            raise _refuse((*where, index), f"{what} '{name}' is declared twice; drop one")
        seen.add(name)


def _check_groups(interface: Declared) -> None:
    channels = {channel.name for channel in interface.channels}
    for index, source in enumerate(interface.sources):
        if source.correlation_group in channels:
            raise _refuse(
                ("sources", index, "correlation_group"),
                f"correlation group '{source.correlation_group}' has the name of a channel; "
                "rename one, because a fault may name either",
            )


def _check_channel(known: Mapping[str, Source], channel: Channel, where: Where) -> None:
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


def _check_reconstructions(interface: Declared) -> None:
    for module, names in interface.reconstructs.items():
        _check_unique(f"reconstructs: module '{module}': source", names, "reconstructs", module)
    known = {source.name: source for source in interface.sources}
    readers = {consumer.split(".")[0] for c in interface.channels for consumer in c.consumers}
    for module, name in interface.reconstructions:
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
    produced = {name for _, name in interface.reconstructions}
    for index, source in enumerate(interface.sources):
        if source.provenance == "reconstructed" and source.name not in produced:
            raise _refuse(
                ("sources", index, "provenance"),
                f"source '{source.name}' is reconstructed but no module produces it; add it to "
                "reconstructs",
            )


def _check_cycles(interface: Declared) -> None:
    """Refuse modules that reconstruct what they themselves need within a step."""
    read_by = readers(interface)
    waiting = {
        module: {reader for name in names for reader in read_by.get(name, ())}
        for module, names in interface.reconstructs.items()
    }
    while leaves := [m for m, below in waiting.items() if not below & waiting.keys()]:
        for module in leaves:  # nothing that they make comes back to them
            del waiting[module]
    if not waiting:
        return
    path = [next(iter(waiting))]
    while path[-1] not in path[:-1]:
        path.append(min(waiting[path[-1]] & waiting.keys()))
    cycle = " -> ".join(path[path.index(path[-1]) :])
    raise _refuse(
        ("reconstructs", path[-1]),
        f"reconstructs: {cycle} is a cycle; a module that needs its own past keeps it in "
        "its memory instead of reading it through a channel",
    )
