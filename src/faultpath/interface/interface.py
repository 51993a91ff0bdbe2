"""The interface of a system as a whole: its consistency, and the readers that a fault reaches.

Each refusal says where and what to do. Reaching is recursive, as in the paper: a module that reads
a channel and reconstructs a source passes the channel's faults on to all readers of its output.
"""

from collections import deque
from collections.abc import Iterable, Mapping
from typing import Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from faultpath.core.arrays import misfit
from faultpath.core.errors import UserError
from faultpath.core.results import Frozen
from faultpath.core.text import listed, unknown
from faultpath.interface.declaration import Channel, Name, Source, SourceNames

Where = tuple[str | int, ...]


def _refuse(where: Where, sentence: str) -> PydanticCustomError:
    return PydanticCustomError("interface", "{sentence}", {"sentence": sentence, "where": where})


class Interface(Frozen, allow_inf_nan=False):
    """All sources and channels of a system, and the sources that modules produce."""

    name: Name
    sources: tuple[Source, ...]
    channels: tuple[Channel, ...]
    reconstructs: dict[Name, SourceNames] = Field(default_factory=dict[str, tuple[str, ...]])
    """Module to the sources that it produces; a file may give a single one without a list."""

    @property
    def reconstructions(self) -> tuple[tuple[str, str], ...]:
        """Pairs of a module and a source that it produces."""
        return tuple(
            (module, name) for module, names in self.reconstructs.items() for name in names
        )

    def source(self, name: str) -> Source:
        """Return the source called `name`; raises `UserError` with the known names."""
        for source in self.sources:
            if source.name == name:
                return source
        known = (source.name for source in self.sources)
        raise UserError(f"interface {self.name}: {unknown('source', name, known)}")

    def shaped(self, shapes: Mapping[str, tuple[int, ...]]) -> Self:
        """Return the interface with other shapes of some sources, by name.

        They may depend on settings, such as the number of candidates that a planner draws or of
        windows in one scene. Raises `UserError` for an unknown source.
        """
        for name in shapes:
            self.source(name)
        sources = (
            source.model_copy(update={"shape": shapes.get(source.name, source.shape)})
            for source in self.sources
        )
        return self.model_copy(update={"sources": tuple(sources)})

    def channel(self, name: str) -> Channel:
        """Return the channel called `name`; raises `UserError` with the known names."""
        for channel in self.channels:
            if channel.name == name:
                return channel
        known = (channel.name for channel in self.channels)
        raise UserError(f"interface {self.name}: {unknown('channel', name, known)}")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        _check_unique("source", (s.name for s in self.sources), "sources")
        _check_unique("channel", (c.name for c in self.channels), "channels")
        channels = {channel.name for channel in self.channels}
        for index, source in enumerate(self.sources):
            if source.correlation_group in channels:
                raise _refuse(
                    ("sources", index, "correlation_group"),
                    f"correlation group '{source.correlation_group}' has the name of a channel; "
                    "rename one, because a fault may name either",
                )
        known = {source.name: source for source in self.sources}
        for index, channel in enumerate(self.channels):
            _check_channel(known, channel, ("channels", index))
        _check_reconstructions(self, known)
        return self


def _check_unique(what: str, names: Iterable[str], *where: str | int) -> None:
    seen: set[str] = set()
    for index, name in enumerate(names):
        if name in seen:
            raise _refuse((*where, index), f"{what} '{name}' is declared twice; drop one")
        seen.add(name)


def _check_channel(known: Mapping[str, Source], channel: Channel, where: Where) -> None:
    _check_unique(f"channel '{channel.name}': source", channel.sources, *where, "sources")
    _check_unique(f"channel '{channel.name}': reader", channel.readers, *where, "readers")
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


def _check_reconstructions(interface: Interface, known: Mapping[str, Source]) -> None:
    for module, names in interface.reconstructs.items():
        _check_unique(f"reconstructs: module '{module}': source", names, "reconstructs", module)
    readers = modules(interface)
    for module, name in interface.reconstructions:
        here = ("reconstructs", module)
        if module not in readers:
            raise _refuse(
                here,
                f"reconstructs: module '{module}' reads no channel; name its readers in the "
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


def module_of(reader: str) -> str:
    """Return the module of a reader `module.place`."""
    return reader.partition(".")[0]


def modules(interface: Interface) -> tuple[str, ...]:
    """Return all modules with a reader, in order of declaration."""
    return tuple(dict.fromkeys(module_of(name) for c in interface.channels for name in c.readers))


def transitive_readers(interface: Interface, channel: str) -> tuple[str, ...]:
    """Return the readers that a fault on `channel` reaches, directly or through reconstructions.

    Raises `UserError` for an unknown name.
    """
    fed: dict[str, list[int]] = {}
    for index, other in enumerate(interface.channels):
        for source in other.sources:
            fed.setdefault(source, []).append(index)
    reached: dict[str, None] = {}
    waiting = deque([interface.channel(channel)])
    seen, followed = {channel}, set[str]()
    while waiting:
        here = waiting.popleft()
        reached.update(dict.fromkeys(here.readers))
        outputs = interface.reconstructs.get
        fresh = {source for c in here.readers for source in outputs(module_of(c), ())} - followed
        followed |= fresh
        for index in sorted({index for source in fresh for index in fed.get(source, ())}):
            other = interface.channels[index]
            if other.name not in seen:
                seen.add(other.name)
                waiting.append(other)
    return tuple(reached)


def rank(interface: Interface) -> tuple[Channel, ...]:
    """Return the channels in the order in which to audit them.

    They are ordered by the number of readers that a fault reaches, the number that read the channel
    itself, and the expected relative uncertainty of its first source, the unknown last (paper,
    section "Propose Repairs, Then Audit Their Composition").
    """

    def order(channel: Channel) -> tuple[int, int, float, str]:
        expected = interface.source(channel.sources[0]).expected_uncertainty
        reach = len(transitive_readers(interface, channel.name))
        weight = -1.0 if expected is None else expected
        return -reach, -len(channel.readers), -weight, channel.name

    return tuple(sorted(interface.channels, key=order))


def groups(interface: Interface) -> dict[str, tuple[str, ...]]:
    """Return each error-correlation group and the channels that its sources feed."""
    fed: dict[str, dict[str, None]] = {}
    for channel in interface.channels:
        for name in channel.sources:
            group = interface.source(name).correlation_group
            if group is not None:
                fed.setdefault(group, {})[channel.name] = None
    return {group: tuple(channels) for group, channels in fed.items()}
