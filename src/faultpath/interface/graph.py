"""Who reads what, directly and through reconstructions.

The paper's rule is recursive: a module that reads a channel and reconstructs a source passes the
channel's faults on to everything that reads its output.
"""

from collections import deque

from faultpath.interface.model import Channel, Declared


def module_of(consumer: str) -> str:
    """Return the module of a consumer `module.place`."""
    return consumer.partition(".")[0]


def modules(interface: Declared) -> tuple[str, ...]:
    """Return every module that reads something, in the order of declaration."""
    return tuple(dict.fromkeys(module_of(name) for c in interface.channels for name in c.consumers))


def readers(interface: Declared) -> dict[str, tuple[str, ...]]:
    """Return the modules that read each source, in the order of declaration."""
    found: dict[str, dict[str, None]] = {}
    for channel in interface.channels:
        names = dict.fromkeys(map(module_of, channel.consumers))
        for source in channel.sources:
            found.setdefault(source, {}).update(names)
    return {source: tuple(names) for source, names in found.items()}


def transitive_consumers(interface: Declared, channel: str) -> tuple[str, ...]:
    """Return the consumers that a fault on `channel` reaches, directly or through reconstructions.

    Raises `UserError` for an unknown name.
    """
    fed: dict[str, list[int]] = {}
    for index, each in enumerate(interface.channels):
        for source in each.sources:
            fed.setdefault(source, []).append(index)
    reached: dict[str, None] = {}
    waiting = deque([interface.channel(channel)])
    seen, followed = {channel}, set[str]()
    while waiting:
        here = waiting.popleft()
        reached.update(dict.fromkeys(here.consumers))
        made_by = interface.reconstructs.get
        fresh = {made for c in here.consumers for made in made_by(module_of(c), ())} - followed
        followed |= fresh
        for index in sorted({index for source in fresh for index in fed.get(source, ())}):
            other = interface.channels[index]
            if other.name not in seen:
                seen.add(other.name)
                waiting.append(other)
    return tuple(reached)


def rank(interface: Declared) -> tuple[Channel, ...]:
    """Return the channels, the one to audit first in front.

    By how many consumers a fault reaches, how many read the channel itself, and the expected
    relative uncertainty of its first source, where an unknown one counts least (paper, section
    "Propose Repairs, Then Audit Their Composition").
    """

    def order(channel: Channel) -> tuple[int, int, float, str]:
        expected = interface.source(channel.sources[0]).expected_uncertainty
        reach = len(transitive_consumers(interface, channel.name))
        weight = -1.0 if expected is None else expected
        return -reach, -len(channel.consumers), -weight, channel.name

    return tuple(sorted(interface.channels, key=order))


def groups(interface: Declared) -> dict[str, tuple[str, ...]]:
    """Return each error-correlation group and the channels that its sources feed."""
    found: dict[str, dict[str, None]] = {}
    for channel in interface.channels:
        for name in channel.sources:
            group = interface.source(name).correlation_group
            if group is not None:
                found.setdefault(group, {})[channel.name] = None
    return {group: tuple(channels) for group, channels in found.items()}
