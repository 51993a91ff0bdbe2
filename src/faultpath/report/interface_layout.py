"""Where the parts of an interface drawing stand: an order with few crossings, then coordinates.

Three columns: sources, channels, and taps gathered by module and place. The order starts as
declared and is improved by a few barycentre sweeps; of the orders met, the one with the fewest
crossing wires is kept, and the declared one wins ties, so that a drawing stays put when it can.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, groupby

from faultpath.interface import Interface

Tap = tuple[str, str]
"""`(channel, consumer)`."""

MARGIN_TOP = 40.0
SOURCE_PITCH, SOURCE_HEIGHT = 44.0, 36.0
CHANNEL_HEIGHT = 34.0
TAP_PITCH, PLACE_GAP, MODULE_HEAD, MODULE_GAP = 18.0, 5.0, 28.0, 16.0


@dataclass(frozen=True)
class ModuleBlock:
    """One module in the right column: `top` to `bottom`, and its taps row by row."""

    name: str
    top: float
    bottom: float
    rows: tuple[tuple[Tap, float], ...]


@dataclass(frozen=True)
class Layout:
    """Vertical centres of everything, in pixels."""

    sources: Mapping[str, float]
    channels: Mapping[str, float]
    modules: tuple[ModuleBlock, ...]
    bottom: float

    @property
    def taps(self) -> dict[Tap, float]:
        """Return the centre of every tap."""
        return {tap: y for module in self.modules for tap, y in module.rows}


@dataclass(frozen=True)
class _Order:
    sources: tuple[str, ...]
    channels: tuple[str, ...]
    taps: tuple[Tap, ...]


def lay_out(interface: Interface) -> Layout:
    """Return where every part stands."""
    order = _best_order(interface)
    heights = _stack(order.taps, 0.0)[-1].bottom if order.taps else 0.0
    tallest = max(len(order.sources) * SOURCE_PITCH, heights, len(order.channels) * 40.0)
    pitch = tallest / max(len(order.sources), 1)
    sources = {name: MARGIN_TOP + pitch * (i + 0.5) for i, name in enumerate(order.sources)}
    modules = _stack(order.taps, MARGIN_TOP + 0.5 * (tallest - heights))
    taps = {tap: y for module in modules for tap, y in module.rows}
    channels = _near_neighbours(interface, order, sources, taps, tallest)
    return Layout(sources, channels, modules, MARGIN_TOP + tallest)


def _best_order(interface: Interface) -> _Order:
    order = _declared(interface)
    best, fewest = order, _crossings(interface, order)
    for _ in range(6):
        order = _swept(interface, order)
        for candidate in (order, _exchanged(interface, order)):
            crossings = _crossings(interface, candidate)
            if crossings < fewest:
                best, fewest = candidate, crossings
    return best


def _exchanged(interface: Interface, order: _Order) -> _Order:
    """Exchange neighbouring channels as long as that takes crossings away."""
    fewest, improved = _crossings(interface, order), True
    while improved:
        improved = False
        for i in range(len(order.channels) - 1):
            names = list(order.channels)
            names[i], names[i + 1] = names[i + 1], names[i]
            taps = _gathered(order.taps, {name: float(k) for k, name in enumerate(names)})
            candidate = _Order(order.sources, tuple(names), taps)
            crossings = _crossings(interface, candidate)
            if crossings < fewest:
                order, fewest, improved = candidate, crossings, True
    return order


def _declared(interface: Interface) -> _Order:
    channels = tuple(c.name for c in interface.channels)
    sources = tuple(s.name for s in interface.sources)
    group = {s.name: s.correlation_group or s.name for s in interface.sources}
    groups = list(dict.fromkeys(group.values()))
    sources = tuple(sorted(sources, key=lambda s: groups.index(group[s])))
    taps = tuple((c.name, consumer) for c in interface.channels for consumer in c.consumers)
    return _Order(sources, channels, _gathered(taps, {c: i for i, c in enumerate(channels)}))


def _swept(interface: Interface, order: _Order) -> _Order:
    """Pull channels towards taps and sources, then both towards the channels."""
    source_at = {s: i / len(order.sources) for i, s in enumerate(order.sources)}
    tap_at = {t: i / len(order.taps) for i, t in enumerate(order.taps)}
    wanted = {
        c.name: _mean([source_at[s] for s in c.sources] + [tap_at[c.name, x] for x in c.consumers])
        for c in interface.channels
    }
    channels = tuple(sorted(order.channels, key=lambda c: wanted[c]))
    channel_at = {c: float(i) for i, c in enumerate(channels)}
    fed = {
        s.name: [channel_at[c.name] for c in interface.channels if s.name in c.sources]
        for s in interface.sources
    }
    pull = {s: _mean(at) if at else float(len(channels)) for s, at in fed.items()}
    group = {s.name: s.correlation_group or s.name for s in interface.sources}
    group_pull = {g: _mean([pull[s] for s in pull if group[s] == g]) for g in group.values()}
    sources = tuple(sorted(order.sources, key=lambda s: (group_pull[group[s]], group[s], pull[s])))
    return _Order(sources, channels, _gathered(order.taps, channel_at))


def _gathered(taps: Sequence[Tap], channel_at: Mapping[str, float]) -> tuple[Tap, ...]:
    """Sort taps by module, place and channel, each at the mean of the channels it reads."""

    def pull(key: Callable[[Tap], str]) -> dict[str, float]:
        names = {key(tap) for tap in taps}
        return {n: _mean([channel_at[t[0]] for t in taps if key(t) == n]) for n in names}

    modules, places = pull(_module), pull(lambda tap: tap[1])
    return tuple(
        sorted(
            taps,
            key=lambda t: (modules[_module(t)], _module(t), places[t[1]], t[1], channel_at[t[0]]),
        )
    )


def _crossings(interface: Interface, order: _Order) -> int:
    source_at = {s: i for i, s in enumerate(order.sources)}
    channel_at = {c: i for i, c in enumerate(order.channels)}
    tap_at = {t: i for i, t in enumerate(order.taps)}
    left = [(source_at[s], channel_at[c.name]) for c in interface.channels for s in c.sources]
    right = [(channel_at[t[0]], tap_at[t]) for t in order.taps]
    return sum(
        (a[0] - b[0]) * (a[1] - b[1]) < 0
        for wires in (left, right)
        for a, b in combinations(wires, 2)
    )


def _near_neighbours(
    interface: Interface,
    order: _Order,
    sources: Mapping[str, float],
    taps: Mapping[Tap, float],
    tallest: float,
) -> dict[str, float]:
    """Set each channel near what it connects, keeping the order and room for its box."""
    by_name = {c.name: c for c in interface.channels}
    pitch = CHANNEL_HEIGHT + 8.0
    wanted: list[float] = []
    for name in order.channels:
        channel = by_name[name]
        ends = [sources[channel.sources[0]], _mean([taps[name, x] for x in channel.consumers])]
        wanted.append(_mean(ends))
    low, high = MARGIN_TOP + pitch / 2, MARGIN_TOP + tallest - pitch / 2
    free = _rising([y - i * pitch for i, y in enumerate(wanted)])
    last = high - (len(free) - 1) * pitch
    placed = [min(max(y, low), last) + i * pitch for i, y in enumerate(free)]
    return dict(zip(order.channels, placed, strict=True))


def _rising(values: Sequence[float]) -> list[float]:
    pools: list[tuple[float, int]] = []
    for value in values:
        total, size = value, 1
        while pools and pools[-1][0] / pools[-1][1] > total / size:
            total, size = total + pools[-1][0], size + pools[-1][1]
            pools.pop()
        pools.append((total, size))
    return [total / size for total, size in pools for _ in range(size)]


def _stack(taps: Sequence[Tap], top: float) -> tuple[ModuleBlock, ...]:
    blocks: list[ModuleBlock] = []
    for module, inside in groupby(taps, _module):
        y = top + MODULE_HEAD
        rows: list[tuple[Tap, float]] = []
        for _, place in groupby(inside, lambda tap: tap[1]):
            for tap in place:
                rows.append((tap, y + TAP_PITCH / 2))
                y += TAP_PITCH
            y += PLACE_GAP
        blocks.append(ModuleBlock(module, top, y + 3, tuple(rows)))
        top = y + 3 + MODULE_GAP
    return tuple(blocks)


def _module(tap: Tap) -> str:
    return tap[1].partition(".")[0]


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)
