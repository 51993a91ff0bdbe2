"""The information interface as a picture: who reads what, from where, and what a fault strikes."""

from collections.abc import Sequence

from faultpath.interface import Channel, Gap, Interface, Source
from faultpath.report.interface_layout import (
    CHANNEL_HEIGHT,
    SOURCE_HEIGHT,
    Layout,
    lay_out,
)
from faultpath.report.interface_taps import (
    BESIDE,
    BLOCK_W,
    TAP_X,
    draw_diamond,
    draw_module,
    draw_tag,
)
from faultpath.report.interface_wiring import StruckPath, Who, Wiring, hits
from faultpath.report.provenance_glyphs import draw_gap, draw_provenance
from faultpath.report.svg import Svg, shortened, text_width
from faultpath.trials.shown import VariantShown

_SOURCE_X, _SOURCE_W = 46.0, 214.0
_CHANNEL_X, _CHANNEL_W = 332.0, 142.0
_LANE = 16.0


def draw_interface(
    interface: Interface,
    struck: Sequence[StruckPath] = (),
    variants: tuple[VariantShown, ...] = (),
    standalone: bool = True,
) -> str:
    """Return the drawing as SVG markup: a file of its own, or a part of a page with its styles.

    `variants` are baseline and repair: each tap has a sign for either, a feed that only one of them
    uses carries its letter, and what neither uses is dashed. It may be one variant alone, as it
    ran: what it did not use is dashed. Taps that a variant lacks are grey and say why. Every struck
    tap carries the numbers of the paths that strike it, with a letter where one variant alone was
    struck; the key stands below.
    """
    layout, wiring = lay_out(interface), Wiring(variants)
    two = len(variants) > 1
    lanes = len(interface.reconstructions)
    key_top = layout.bottom + 18 + _LANE * lanes + (12 if lanes else 0)
    width = TAP_X + BLOCK_W + 14 + _LANE * max(lanes, 1)
    height = key_top + 28 + 20 * (len(struck) + (len(variants) > 1))
    svg = Svg(width, height, *_told(interface, struck, wiring))
    for x, words in ((_SOURCE_X, "Sources"), (_CHANNEL_X, "Channels"), (TAP_X, "Taps, by module")):
        svg.text(x, 18, words, "head")
    if two:
        for x, by in ((TAP_X, Who.BASELINE), (TAP_X + BESIDE, Who.REPAIR)):
            svg.text(x, 36, by.value, f"bold {by.name.lower()}", "middle")
    for block in layout.modules:
        svg.rect(TAP_X - 14, block.top, BLOCK_W + 14, block.bottom - block.top, "module", 4)
    _source_wires(svg, interface, layout, wiring)
    _tap_wires(svg, layout, struck, wiring)
    _groups(svg, interface, layout)
    for source in interface.sources:
        _source(svg, source, layout.sources[source.name])
    for channel in interface.channels:
        _channel(svg, channel, layout.channels[channel.name])
    for block in layout.modules:
        draw_module(svg, block, struck, wiring)
    _reconstructions(svg, interface, layout, wiring)
    _key(svg, key_top, struck, variants, lanes > 0)
    return svg.render(standalone)


def _told(interface: Interface, struck: Sequence[StruckPath], wiring: Wiring) -> tuple[str, str]:
    def fed(channel: Channel) -> str:
        feeding = [(s, wiring.feeds(channel, s)) for s in channel.sources]
        used = [f"{s}{wiring.words(by)}" for s, by in feeding if by is not Who.NEITHER]
        return " and ".join(used) or "nothing"

    reads = "; ".join(
        f"{channel.name} from {fed(channel)} to "
        + ", ".join(f"{c}{wiring.words(wiring.tap((channel.name, c)))}" for c in channel.consumers)
        for channel in interface.channels
    )
    told = "".join(
        f" {path.words}"
        + "".join(f", {t[0]} at {t[1]}{path.who(t).words}" for t in sorted(path.taps))
        + "."
        for path in struck
    )
    return f"Information interface of {interface.name}", f"{reads}.{told}"


def _source(svg: Svg, source: Source, y: float) -> None:
    detail = [source.provenance.value, *([source.unit] if source.unit != "1" else [])]
    if source.latency_s:
        detail.append(f"{1000 * source.latency_s:g} ms late")
    with svg.group(tip=_tip(source)):
        top, look = y - SOURCE_HEIGHT / 2, f"node {source.provenance.value}"
        svg.rect(_SOURCE_X, top, _SOURCE_W, SOURCE_HEIGHT, look, 4)
        draw_provenance(svg, source.provenance, _SOURCE_X + 17, y)
        x, room = _SOURCE_X + 34, _SOURCE_W - 40
        svg.text(x, y - 3, shortened(source.name, room, 12), "bold")
        svg.text(x, y + 12, shortened(" · ".join(detail), room, 11), "small soft")


def _channel(svg: Svg, channel: Channel, y: float) -> None:
    gap = "no gap" if channel.gap is Gap.NONE else f"{channel.gap.value} gap"
    with svg.group(tip=_tip(channel)):
        top, round_ends = y - CHANNEL_HEIGHT / 2, CHANNEL_HEIGHT / 2
        svg.rect(_CHANNEL_X, top, _CHANNEL_W, CHANNEL_HEIGHT, "node", round_ends)
        draw_gap(svg, channel.gap, _CHANNEL_X + 19, y)
        svg.text(_CHANNEL_X + 36, y - 2, shortened(channel.name, _CHANNEL_W - 50, 12), "bold")
        svg.text(_CHANNEL_X + 36, y + 12, gap, "small soft")


def _tip(named: Source | Channel) -> str:
    return f"{named.name}: {named.description}" if named.description else named.name


def _source_wires(svg: Svg, interface: Interface, layout: Layout, wiring: Wiring) -> None:
    for channel in interface.channels:
        for name in channel.sources:
            start = (_SOURCE_X + _SOURCE_W, layout.sources[name])
            end = (_CHANNEL_X, layout.channels[channel.name])
            by = wiring.feeds(channel, name)
            svg.path(_curve(start, end), _wire(by))
            middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2 + 4)
            _letter(svg, by, middle, f"{name} feeds {channel.name}{wiring.words(by)}")


def _tap_wires(svg: Svg, layout: Layout, struck: Sequence[StruckPath], wiring: Wiring) -> None:
    ordered = sorted(layout.taps.items(), key=lambda item: bool(hits(item[0], struck)))
    for tap, y in ordered:
        d = _curve((_CHANNEL_X + _CHANNEL_W, layout.channels[tap[0]]), (TAP_X, y))
        found = hits(tap, struck)
        if found:
            svg.path(d, "wire hit", data_hit=" ".join(str(number) for number, _ in found))
        else:
            svg.path(d, _wire(wiring.tap(tap)))


def _wire(by: Who) -> str:
    return "wire other" if by is Who.NEITHER else "wire"


def _letter(svg: Svg, by: Who, at: tuple[float, float], tip: str) -> None:
    """Write whose alone something is; nothing where it is everybody's or nobody's."""
    if by in (Who.BASELINE, Who.REPAIR):
        svg.text(*at, by.value, f"bold halo {by.name.lower()}", "middle", tip=tip)


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


def _reconstructions(svg: Svg, interface: Interface, layout: Layout, wiring: Wiring) -> None:
    """Lead what a module reconstructs round the drawing, back to the source it makes."""
    tops = {block.name: block.top for block in layout.modules}
    for lane, (module, source) in enumerate(interface.reconstructions):
        right = TAP_X + BLOCK_W + 10 + _LANE * lane
        below = layout.bottom + 14 + _LANE * lane
        left, start, end = 6.0 + 5 * lane, tops[module] + 14, layout.sources[source]
        svg.path(
            f"M{TAP_X + BLOCK_W} {start}H{right - 6}q6 0 6 6V{below - 8}q0 8 -8 8"
            f"H{left + 8}q-8 0 -8 -8V{end + 8}q0 -8 8 -8H{_SOURCE_X - 7}",
            "back",
        )
        svg.polygon(
            [(_SOURCE_X - 1, end), (_SOURCE_X - 9, end - 4), (_SOURCE_X - 9, end + 4)], "arrow"
        )
        words = f"{module} reconstructs {source}{wiring.words(wiring.module(module))}"
        room = text_width(words, 11)
        middle = _CHANNEL_X + _CHANNEL_W / 2
        svg.rect(middle - room / 2 - 4, below - 7, room + 8, 14, "paper")
        svg.text(middle, below + 4, words, "small", "middle")


def _key(
    svg: Svg,
    top: float,
    struck: Sequence[StruckPath],
    variants: tuple[VariantShown, ...],
    reconstructs: bool,
) -> None:
    x, y = _SOURCE_X, top + 12
    svg.circle((x + 4, y - 4), 3.5, "tap")
    svg.text(x + 16, y, "tap", "small soft")
    if len(variants) > 1:
        svg.path(f"M{x + 560} {y - 4}h6", "lacking")
        svg.text(x + 574, y, "the variant has no such tap", "small soft")
    svg.path(f"M{x + 56} {y - 4}h24", "wire other")
    unused = "used by neither variant" if len(variants) > 1 else "declared, not read here"
    other = unused if variants else "other source that may feed the channel"
    svg.text(x + 86, y, other, "small soft")
    if reconstructs:
        svg.path(f"M{x + 322} {y - 4}h26", "back")
        svg.text(x + 354, y, "reconstruction", "small soft")
    if len(variants) > 1:
        y += 20
        for left, by, variant in zip(
            (x, x + 420), (Who.BASELINE, Who.REPAIR), variants, strict=True
        ):
            svg.text(left + 4, y, by.value, f"bold {by.name.lower()}", "middle")
            words = f"the {by.name.lower()}, {variant.name} (at a feed: it alone uses it)"
            svg.text(left + 16, y, shortened(words, 380, 11), "small soft", tip=variant.description)
    for number, path in enumerate(struck, 1):
        y += 20
        draw_diamond(svg, x + 4, y - 4)
        draw_tag(svg, x + 24, y - 4, number, Who.BOTH)
        svg.text(x + 40, y, shortened(path.words, 780, 12), tip=path.title)


def _curve(start: tuple[float, float], end: tuple[float, float]) -> str:
    (x0, y0), (x1, y1) = start, end
    bend = 0.5 * (x1 - x0)
    return f"M{x0:.1f} {y0:.1f}C{x0 + bend:.1f} {y0:.1f} {x1 - bend:.1f} {y1:.1f} {x1:.1f} {y1:.1f}"
