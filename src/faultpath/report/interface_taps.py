"""The taps of an interface drawing: a block for each module, a sign for each variant at a tap."""

from collections.abc import Sequence

from faultpath.report.interface_layout import ModuleBlock, Tap
from faultpath.report.interface_wiring import StruckPath, Who, Wiring, hits
from faultpath.report.svg import Svg, shortened, text_width

TAP_X, BLOCK_W = 594.0, 310.0
_PLACE_X, _READS_X = 30.0, 158.0
BESIDE = 13.0
"""From the sign of the baseline at a tap to that of the repair."""


def draw_module(svg: Svg, block: ModuleBlock, struck: Sequence[StruckPath], wiring: Wiring) -> None:
    """Draw what stands in a module's block, row by row."""
    svg.text(TAP_X, block.top + 18, shortened(block.name, BLOCK_W - 10, 12), "bold")
    place_before = ""
    for tap, y in block.rows:
        channel, consumer = tap
        place = consumer.partition(".")[2]
        if place != place_before:
            label = shortened(place, _READS_X - _PLACE_X - 8, 12)
            svg.text(TAP_X + _PLACE_X, y + 4, label, tip=consumer)
        place_before = place
        found = hits(tap, struck)
        used = sum(_tag_width(*hit) + 2 for hit in found)
        reason = _reason(tap, wiring)
        look = "small soft" if wiring.tap(tap) is not Who.NEITHER else "small faint"
        name = shortened(channel, BLOCK_W - _READS_X - 14 - used, 11)
        svg.text(TAP_X + _READS_X, y + 4, name, look)
        if reason:
            x = TAP_X + _READS_X + text_width(name, 11) + 8
            room = TAP_X + BLOCK_W - 10 - used - x
            svg.text(
                x, y + 4, shortened(reason, room, 10), "tiny faint", tip=f"{consumer}: {reason}"
            )
        _tap(svg, y, tap, struck, wiring)
        _tags(svg, y, found)


def _reason(tap: Tap, wiring: Wiring) -> str:
    """Say which variant lacks a tap, and why; empty where both have it."""
    if len(wiring.variants) < 2:
        return ""
    baseline, repair = wiring.lacking(tap)
    if baseline == repair:
        return repair
    lone = zip((Who.BASELINE, Who.REPAIR), (baseline, repair), strict=True)
    return "; ".join(f"{by.value}: {why}" for by, why in lone if why)


def _tap(svg: Svg, y: float, tap: Tap, struck: Sequence[StruckPath], wiring: Wiring) -> None:
    """Draw the sign of each variant at a tap; of one variant, or none, a single one."""
    by, at = wiring.tap(tap), f"{tap[0]} at {tap[1]}"
    if len(wiring.variants) < 2:
        numbers = [number for number, _ in hits(tap, struck)]
        _sign(svg, TAP_X, y, numbers, by is not Who.NEITHER, f"{at}{wiring.words(by)}")
        return
    for place, who in enumerate((Who.BASELINE, Who.REPAIR)):
        numbers = [
            n for n, path in enumerate(struck, 1) if tap in (path.baseline, path.repair)[place]
        ]
        why = wiring.lacking(tap)[place]
        tip = f"{at}, {who.name.lower()} {wiring.variants[place].name}"
        tip += f": {why}" if why else ": struck" if numbers else ""
        _sign(svg, TAP_X + place * BESIDE, y, numbers, not why, tip)


def _sign(svg: Svg, x: float, y: float, numbers: Sequence[int], reads: bool, tip: str) -> None:
    if numbers:
        with svg.group("struck-tap", data_hit=" ".join(map(str, numbers))):
            draw_diamond(svg, x, y, tip)
    elif reads:
        svg.circle((x, y), 3.5, "tap", tip=tip)
    else:
        svg.path(f"M{x - 3} {y}h6", "lacking", tip=tip)


def _tags(svg: Svg, y: float, found: Sequence[tuple[int, Who]]) -> None:
    right = TAP_X + BLOCK_W - 6
    for number, struck_in in reversed(found):
        width = _tag_width(number, struck_in)
        with svg.group("tag-mark", data_hit=str(number)):
            draw_tag(svg, right - width / 2, y, number, struck_in)
        right -= width + 2


def draw_diamond(svg: Svg, x: float, y: float, tip: str | None = None) -> None:
    """Draw the sign of a struck tap."""
    svg.polygon([(x - 6.5, y), (x, y - 6.5), (x + 6.5, y), (x, y + 6.5)], "tap hit", tip)


def draw_tag(svg: Svg, x: float, y: float, number: int, by: Who) -> None:
    """Draw the number of a path that strikes a tap."""
    width = _tag_width(number, by)
    svg.rect(x - width / 2, y - 7.5, width, 15, "tag", 7.5)
    svg.text(x, y + 3.5, f"{number}{by.value}", "on-tag", "middle")


def _tag_width(number: int, by: Who) -> float:
    return max(15.0, text_width(f"{number}{by.value}", 10) + 8)
