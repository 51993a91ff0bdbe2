"""Who reads what, directly and through reconstructions.

The paper's rule is recursive: a module that reads a channel and reconstructs a source passes the
channel's faults on to everything that reads its output.
"""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

from faultpath.interface.model import Declared


def module_of(consumer: str) -> str:
    """Return the module of a consumer `module.place`."""
    return consumer.partition(".")[0]


def modules(interface: Declared) -> tuple[str, ...]:
    """Return every module that reads something, in the order of declaration."""
    return tuple(dict.fromkeys(module_of(name) for c in interface.channels for name in c.consumers))


def feeds(
    interface: Declared, module: str, bindings: Mapping[str, str] | None = None
) -> tuple[str, ...]:
    """Return the modules that read what `module` reconstructs.

    With `bindings` (channel to source) only the channels bound to that source count; without,
    every channel that the source may feed.
    """
    produced = interface.reconstructs.get(module)
    return () if produced is None else readers(interface, bindings).get(produced, ())


def readers(
    interface: Declared, bindings: Mapping[str, str] | None = None
) -> dict[str, tuple[str, ...]]:
    """Return the modules that read each source, in the order of declaration; `bindings` as above.

    In one pass, for whoever asks about many modules.
    """
    found: dict[str, dict[str, None]] = {}
    for source, fed in _fed(interface, bindings).items():
        names = (name for index in fed for name in interface.channels[index].consumers)
        found[source] = dict.fromkeys(map(module_of, names))
    return {source: tuple(names) for source, names in found.items()}


def _fed(interface: Declared, bindings: Mapping[str, str] | None) -> dict[str, list[int]]:
    """Return, for each source, the places of the channels that it feeds."""
    found: dict[str, list[int]] = {}
    for index, channel in enumerate(interface.channels):
        for source in (bindings[channel.name],) if bindings else channel.sources:
            found.setdefault(source, []).append(index)
    return found


def direct_consumers(interface: Declared, channel: str) -> tuple[str, ...]:
    """Return the consumers that read `channel` itself; raises `UserError` for an unknown name."""
    return interface.channel(channel).consumers


def transitive_consumers(
    interface: Declared, channel: str, bindings: Mapping[str, str] | None = None
) -> tuple[str, ...]:
    """Return the consumers that a fault on `channel` reaches, directly or through reconstructions.

    `bindings` as in `feeds`. Raises `UserError` for an unknown name.
    """
    reached: dict[str, None] = {}
    fed = _fed(interface, bindings)
    waiting = deque([interface.channel(channel)])
    seen, followed = {channel}, set[str]()
    while waiting:
        here = waiting.popleft()
        reached.update(dict.fromkeys(here.consumers))
        produced = {interface.reconstructs.get(module_of(name), "") for name in here.consumers}
        fresh = produced - followed
        followed |= fresh
        for index in sorted({index for source in fresh for index in fed.get(source, ())}):
            other = interface.channels[index]
            if other.name not in seen:
                seen.add(other.name)
                waiting.append(other)
    return tuple(reached)


@dataclass(frozen=True)
class Ranked:
    """One channel's place in the order of audit."""

    channel: str
    transitive: int
    """Consumers that a fault reaches."""
    direct: int
    """Consumers that read the channel itself."""
    weight: float | None
    """Probe response where one was given, else the expected uncertainty of the first source."""


def rank(interface: Declared, responses: Mapping[str, float] | None = None) -> tuple[Ranked, ...]:
    """Return the channels, the one to audit first in front.

    By consumer count, then by `responses` (channel to probe response at the expected deployment
    uncertainty) or, without them, by the expected relative uncertainty; unknown counts last. Paper,
    section "Propose Repairs, Then Audit Their Composition".
    """

    def ranked(name: str, source: str) -> Ranked:
        expected = interface.source(source).expected_uncertainty
        return Ranked(
            channel=name,
            transitive=len(transitive_consumers(interface, name)),
            direct=len(direct_consumers(interface, name)),
            weight=expected if responses is None else responses.get(name),
        )

    found = [ranked(channel.name, channel.sources[0]) for channel in interface.channels]
    found.sort(
        key=lambda r: (
            -r.transitive,
            -r.direct,
            -(r.weight if r.weight is not None else -1.0),
            r.channel,
        )
    )
    return tuple(found)


def groups(interface: Declared) -> dict[str, tuple[str, ...]]:
    """Return each error-correlation group and the channels that its sources feed."""
    found: dict[str, dict[str, None]] = {}
    for channel in interface.channels:
        for name in channel.sources:
            group = interface.source(name).correlation_group
            if group is not None:
                found.setdefault(group, {})[channel.name] = None
    return {group: tuple(channels) for group, channels in found.items()}
