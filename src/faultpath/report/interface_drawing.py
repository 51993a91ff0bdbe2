"""The information interface as a picture: who reads what, from where, and what a fault strikes."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from faultpath.interface import Channel, Gap, Interface, Source
from faultpath.record.model import DecisionRecord
from faultpath.report.interface_layout import (
    CHANNEL_HEIGHT,
    SOURCE_HEIGHT,
    Layout,
    ModuleBlock,
    Tap,
    lay_out,
)
from faultpath.report.provenance_glyphs import draw_gap, draw_provenance
from faultpath.report.svg import Svg, shortened, text_width

_SOURCE_X, _SOURCE_W = 46.0, 214.0
_CHANNEL_X, _CHANNEL_W = 332.0, 142.0
_TAP_X, _BLOCK_W = 594.0, 310.0
_PLACE_X, _READS_X = 16.0, 148.0
_LANE = 12.0


@dataclass(frozen=True)
class StruckPath:
    """One path of a fault and the taps that it strikes."""

    name: str
    title: str
    taps: frozenset[Tap]


def struck_paths(interface: Interface, record: DecisionRecord) -> tuple[StruckPath, ...]:
    """Return the paths of a record that strike something, with their taps.

    A record names consumers, `module.place`, or taps, `channel:module.place`. A bare consumer
    counts for the channels that the fault's words name (directly or by correlation group), and
    for every channel that it reads where they name none.
    """
    named = _channels_in(interface, record.question.fault)
    return tuple(
        StruckPath(path.name, path.title, frozenset(_taps_of(interface, path.consumers, named)))
        for path in record.paths
        if path.consumers
    )


def draw_interface(
    interface: Interface, struck: Sequence[StruckPath] = (), standalone: bool = True
) -> str:
    """Return the drawing as SVG markup: a file of its own, or a part of a page with its styles.

    Every struck tap carries the numbers of the paths that strike it; the key stands below.
    """
    layout = lay_out(interface)
    lanes = len(interface.reconstructs)
    key_top = layout.bottom + 18 + _LANE * lanes + (12 if lanes else 0)
    width = _TAP_X + _BLOCK_W + 14 + _LANE * max(lanes, 1)
    svg = Svg(width, key_top + 28 + 20 * len(struck), *_told(interface, struck))
    for x, words in ((_SOURCE_X, "Sources"), (_CHANNEL_X, "Channels"), (_TAP_X, "Taps, by module")):
        svg.text(x, 18, words, "head")
    for block in layout.modules:
        svg.rect(_TAP_X - 14, block.top, _BLOCK_W + 14, block.bottom - block.top, "module", 4)
    _source_wires(svg, interface, layout)
    _tap_wires(svg, layout, struck)
    _groups(svg, interface, layout)
    for source in interface.sources:
        _source(svg, source, layout.sources[source.name])
    for channel in interface.channels:
        _channel(svg, channel, layout.channels[channel.name])
    for block in layout.modules:
        _module(svg, block, struck)
    _reconstructions(svg, interface, layout)
    _key(svg, key_top, struck, lanes > 0)
    return svg.render(standalone)


def _told(interface: Interface, struck: Sequence[StruckPath]) -> tuple[str, str]:
    reads = "; ".join(
        f"{c.name} from {c.sources[0]} to {', '.join(c.consumers)}" for c in interface.channels
    )
    hits = "".join(
        f" {path.title} strikes {', '.join(f'{c} at {x}' for c, x in sorted(path.taps))}."
        for path in struck
    )
    return f"Information interface of {interface.name}", f"{reads}.{hits}"


def _source(svg: Svg, source: Source, y: float) -> None:
    top = y - SOURCE_HEIGHT / 2
    detail = [source.provenance.value, *([source.unit] if source.unit != "1" else [])]
    if source.latency_s:
        detail.append(f"{1000 * source.latency_s:g} ms late")
    tip = f"{source.name}: {source.description}" if source.description else source.name
    with svg.group(tip=tip):
        svg.rect(_SOURCE_X, top, _SOURCE_W, SOURCE_HEIGHT, f"node {source.provenance.value}", 4)
        draw_provenance(svg, source.provenance, _SOURCE_X + 17, y)
        svg.text(_SOURCE_X + 34, y - 3, shortened(source.name, _SOURCE_W - 40, 12), "bold")
        detail_text = shortened(" · ".join(detail), _SOURCE_W - 40, 11)
        svg.text(_SOURCE_X + 34, y + 12, detail_text, "small soft")


def _channel(svg: Svg, channel: Channel, y: float) -> None:
    top = y - CHANNEL_HEIGHT / 2
    tip = f"{channel.name}: {channel.description}" if channel.description else channel.name
    with svg.group(tip=tip):
        svg.rect(_CHANNEL_X, top, _CHANNEL_W, CHANNEL_HEIGHT, "node", CHANNEL_HEIGHT / 2)
        draw_gap(svg, channel.gap, _CHANNEL_X + 19, y)
        svg.text(_CHANNEL_X + 36, y - 2, shortened(channel.name, _CHANNEL_W - 50, 12), "bold")
        gap = "no gap" if channel.gap is Gap.NONE else f"{channel.gap.value} gap"
        svg.text(_CHANNEL_X + 36, y + 12, gap, "small soft")


def _source_wires(svg: Svg, interface: Interface, layout: Layout) -> None:
    for channel in interface.channels:
        for i, name in enumerate(channel.sources):
            start = (_SOURCE_X + _SOURCE_W, layout.sources[name])
            end = (_CHANNEL_X, layout.channels[channel.name])
            svg.path(_curve(start, end), "wire other" if i else "wire")


def _tap_wires(svg: Svg, layout: Layout, struck: Sequence[StruckPath]) -> None:
    ordered = sorted(layout.taps.items(), key=lambda item: bool(_hits(item[0], struck)))
    for tap, y in ordered:
        d = _curve((_CHANNEL_X + _CHANNEL_W, layout.channels[tap[0]]), (_TAP_X, y))
        hits = _hits(tap, struck)
        if hits:
            svg.path(d, "wire hit", data_hit=" ".join(map(str, hits)))
        else:
            svg.path(d, "wire")


def _module(svg: Svg, block: ModuleBlock, struck: Sequence[StruckPath]) -> None:
    svg.text(_TAP_X, block.top + 18, shortened(block.name, _BLOCK_W - 10, 12), "bold")
    place_before = ""
    for tap, y in block.rows:
        channel, consumer = tap
        place = consumer.partition(".")[2]
        if place != place_before:
            label = shortened(place, _READS_X - _PLACE_X - 8, 12)
            svg.text(_TAP_X + _PLACE_X, y + 4, label, tip=consumer)
        place_before = place
        hits = _hits(tap, struck)
        room = _BLOCK_W - _READS_X - 14 - 17 * len(hits)
        svg.text(_TAP_X + _READS_X, y + 4, shortened(channel, room, 11), "small soft")
        _tap(svg, tap, y, hits)


def _tap(svg: Svg, tap: Tap, y: float, hits: Sequence[int]) -> None:
    if not hits:
        svg.circle((_TAP_X, y), 3.5, "tap", tip=f"{tap[0]} at {tap[1]}")
        return
    x = _TAP_X
    with svg.group("struck-tap", data_hit=" ".join(map(str, hits))):
        svg.polygon([(x - 6.5, y), (x, y - 6.5), (x + 6.5, y), (x, y + 6.5)], "tap hit")
        for k, hit in enumerate(hits):
            centre = _TAP_X + _BLOCK_W - 14 - 17 * (len(hits) - 1 - k)
            with svg.group("tag-mark", data_hit=str(hit)):
                svg.circle((centre, y), 7.5, "tag")
                svg.text(centre, y + 3.5, str(hit), "on-tag", "middle")


def _groups(svg: Svg, interface: Interface, layout: Layout) -> None:
    """Draw a bracket beside sources whose errors have one cause."""
    members: dict[str, list[float]] = {}
    for source in interface.sources:
        if source.correlation_group:
            members.setdefault(source.correlation_group, []).append(layout.sources[source.name])
    for name, ys in members.items():
        top, bottom = min(ys) - SOURCE_HEIGHT / 2 + 2, max(ys) + SOURCE_HEIGHT / 2 - 2
        x = _SOURCE_X - 6
        svg.path(f"M{x} {top}h-5V{bottom}h5", "inner")
        label = shortened(name, bottom - top, 11)
        middle = (top + bottom) / 2
        with svg.group(
            tip=f"errors of these sources have one cause: {name}",
            transform=f"translate({x - 10} {middle}) rotate(-90)",
        ):
            svg.text(0, 0, label, "small soft", "middle")


def _reconstructions(svg: Svg, interface: Interface, layout: Layout) -> None:
    """Lead what a module reconstructs round the drawing, back to the source it makes."""
    tops = {block.name: block.top for block in layout.modules}
    for lane, (module, source) in enumerate(interface.reconstructs.items()):
        right = _TAP_X + _BLOCK_W + 10 + _LANE * lane
        below = layout.bottom + 14 + _LANE * lane
        left, start, end = 6.0 + 5 * lane, tops[module] + 14, layout.sources[source]
        svg.path(
            f"M{_TAP_X + _BLOCK_W} {start}H{right - 6}q6 0 6 6V{below - 8}q0 8 -8 8"
            f"H{left + 8}q-8 0 -8 -8V{end + 8}q0 -8 8 -8H{_SOURCE_X - 7}",
            "back",
        )
        svg.polygon(
            [(_SOURCE_X - 1, end), (_SOURCE_X - 9, end - 4), (_SOURCE_X - 9, end + 4)], "arrow"
        )
        words = f"{module} reconstructs {source}"
        room = text_width(words, 11)
        middle = _CHANNEL_X + _CHANNEL_W / 2
        svg.rect(middle - room / 2 - 4, below - 8, room + 8, 16, "paper")
        svg.text(middle, below + 4, words, "small", "middle")


def _key(svg: Svg, top: float, struck: Sequence[StruckPath], reconstructs: bool) -> None:
    x, y = _SOURCE_X, top + 12
    svg.circle((x + 4, y - 4), 3.5, "tap")
    svg.text(x + 16, y, "tap", "small soft")
    svg.path(f"M{x + 56} {y - 4}h24", "wire other")
    svg.text(x + 86, y, "other source that may feed the channel", "small soft")
    if reconstructs:
        svg.path(f"M{x + 322} {y - 4}h26", "back")
        svg.text(x + 354, y, "reconstruction", "small soft")
    for number, path in enumerate(struck, 1):
        y += 20
        svg.polygon([(x - 2, y - 4), (x + 4, y - 10), (x + 10, y - 4), (x + 4, y + 2)], "tap hit")
        svg.circle((x + 24, y - 4), 7.5, "tag")
        svg.text(x + 24, y - 0.5, str(number), "on-tag", "middle")
        words = f"{path.title}: strikes {len(path.taps)} taps"
        svg.text(x + 40, y, shortened(words, 780, 12), tip=path.title)


def _hits(tap: Tap, struck: Sequence[StruckPath]) -> list[int]:
    return [number for number, path in enumerate(struck, 1) if tap in path.taps]


def _curve(start: tuple[float, float], end: tuple[float, float]) -> str:
    (x0, y0), (x1, y1) = start, end
    bend = 0.5 * (x1 - x0)
    return f"M{x0:.1f} {y0:.1f}C{x0 + bend:.1f} {y0:.1f} {x1 - bend:.1f} {y1:.1f} {x1:.1f} {y1:.1f}"


def _channels_in(interface: Interface, words: str) -> frozenset[str]:
    """Return the channels that a fault's words name, themselves or by their sources' group."""
    asked = {"".join(c if c.isalnum() or c == "_" else " " for c in words)}
    tokens = {token for text in asked for token in text.split()}
    group = {source.name: source.correlation_group for source in interface.sources}
    return frozenset(
        channel.name
        for channel in interface.channels
        if channel.name in tokens or any(group[s] in tokens for s in channel.sources)
    )


def _taps_of(interface: Interface, names: Iterable[str], channels: frozenset[str]) -> set[Tap]:
    found: set[Tap] = set()
    for name in names:
        channel_name, _, consumer = name.rpartition(":")
        readers = [c.name for c in interface.channels if consumer in c.consumers]
        if channel_name:
            readers = [c for c in readers if c == channel_name]
        elif channels.intersection(readers):
            readers = [c for c in readers if c in channels]
        found.update((channel, consumer) for channel in readers)
    return found
