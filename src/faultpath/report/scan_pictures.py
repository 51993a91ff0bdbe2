"""Pictures of a scan: the triangle of pairs, and success with none, each and both of a pair."""

from itertools import product
from string import ascii_uppercase

from faultpath.analyses.scan.model import ScannedPair, ScannedVersion, ScanResult
from faultpath.report.sentences import wording
from faultpath.report.sentences.scan import headline, named, rate
from faultpath.report.svg import Axis, Svg, draw_scale, number, shade, text_width

_CELL, _LEFT, _TOP = 30.0, 24.0, 124.0
_LEAST_SHADED = 0.5
"""From which difference on, pp, a pair has a colour."""
_LEAST = 364.0
"""Width of the narrowest triangle, which its key needs."""
_MOST = 440.0
"""Width of the longest name."""


def letters(version: ScannedVersion) -> dict[int, str]:
    """Return a letter for each error that ran in the second stage, in the order of the errors."""
    places = sorted(single.error for single in version.singles)
    names = (*ascii_uppercase, *map("".join, product(ascii_uppercase, repeat=2)))
    return dict(zip(places, names, strict=False))


def triangle(result: ScanResult, version: ScannedVersion) -> Svg:
    """Return the pairs coloured by what both together regain or lose against the worse one alone,
    the losses of each alone on the diagonal, and the names of the errors below."""
    letter, count = letters(version), len(version.singles)
    side, names_top = count * _CELL, _TOP + count * _CELL + 26
    singles = {single.error: single for single in version.singles}
    names = [f"{named(result.errors[at])}: {rate(singles[at].alone)} alone" for at in letter]
    longest = max((text_width(name, 12) for name in names), default=0.0)
    width = max(_LEAST, _LEFT + side, _LEFT + min(longest, _MOST))
    svg = Svg(
        width,
        names_top + 17 * count + 4,
        f"Pairs of errors in {version.variant}",
        f"{headline(result)} {_described(result, version)}",
    )
    hatch = svg.hatch("untested", "inner", 5)
    _key(svg, hatch, width)
    places, pairs = list(letter), {pair.errors: pair for pair in version.pairs}
    for row, error in enumerate(places):
        top = _TOP + row * _CELL
        svg.text(_LEFT - 8, top + 20, letter[error], "bold", "end")
        svg.text(_LEFT + (row + 0.5) * _CELL, _TOP + side + 16, letter[error], "bold", "middle")
        for column, other in enumerate(places[:row]):
            pair = pairs.get((other, error))
            _cell(svg, result, pair, (_LEFT + column * _CELL, top), hatch)
        single = singles[error]
        loss = wording.signed(single.alone - single.none, 0)
        left = _LEFT + row * _CELL
        svg.rect(left, top, _CELL, _CELL, "inner", tip=f"{named(result.errors[error])}: {loss} pp")
        svg.text(left + _CELL / 2, top + 19, loss, "small soft", "middle")
    for row, (error, name) in enumerate(zip(places, names, strict=True)):
        svg.text(4, names_top + 14 + 17 * row, letter[error], "bold")
        svg.text(_LEFT, names_top + 14 + 17 * row, name, room=width - _LEFT)
    return svg


def _cell(
    svg: Svg, result: ScanResult, pair: ScannedPair | None, at: tuple[float, float], hatch: str
) -> None:
    left, top = at
    square = f"M{number(left)} {number(top)}h{number(_CELL)}v{number(_CELL)}h-{number(_CELL)}Z"
    if pair is None:
        svg.path(square, "", fill=hatch)
        svg.path(square, "inner")
        return
    with svg.group(tip=_tip(result, pair)):
        opacity = shade(pair.gain) if abs(pair.gain) >= _LEAST_SHADED else "0"
        svg.path(square, "repair-only" if pair.gain > 0 else "baseline-only", fill_opacity=opacity)
        svg.path(square, "term both" if pair.kind else "inner")
        if pair.kind:
            text = wording.signed(pair.gain, 0)
            svg.text(left + _CELL / 2, top + 19, text, "small", "middle")


def _tip(result: ScanResult, pair: ScannedPair) -> str:
    first, second = (named(result.errors[place]) for place in pair.errors)
    return (
        f"{first}: {rate(pair.first)}; {second}: {rate(pair.second)}; both: {rate(pair.both)}; "
        f"neither: {rate(pair.none)}"
    )


def _described(result: ScanResult, version: ScannedVersion) -> str:
    """Return the numbers of the listed pairs, for who does not see the picture."""
    texts = [f"{_tip(result, pair)}." for pair in version.listed]
    return " ".join(texts) or f"{len(version.pairs)} pairs were tested and none is listed."


def _key(svg: Svg, hatch: str, width: float) -> None:
    """Draw the scale, and what else a cell may be."""
    svg.text(0, 13, "Success with both errors minus success", "head")
    svg.text(0, 29, "with the worse one alone, percentage points", "head")
    draw_scale(svg, 40)
    svg.path("M1 74h22v12h-22Z", "", fill=hatch)
    svg.path("M1 74h22v12h-22Z", "inner")
    svg.text(29, 84, "not run", "small")
    svg.path("M91 74h22v12h-22Z", "term both")
    svg.text(119, 84, "listed", "small")
    svg.text(1, 105, "−12", "small soft")
    svg.text(29, 105, "on the diagonal: change by that error alone", "small", room=width - 29)


def strip(result: ScanResult, version: ScannedVersion, pair: ScannedPair) -> Svg:
    """Return success without an error, with each of a pair alone and with both, on one scale."""
    letter = letters(version)
    first, second = (letter[place] for place in pair.errors)
    rows = (
        ("no error", pair.none, "dot open"),
        (f"{first} alone", pair.first, "dot"),
        (f"{second} alone", pair.second, "dot"),
        ("both", pair.both, "dot"),
    )
    step, left, width = 20.0, 72.0, 364.0
    svg = Svg(
        width, step * len(rows) + 28, f"Success with {first} and {second}", _tip(result, pair)
    )
    x = Axis(0.0, 100.0, left, width - 56)
    bottom = step * len(rows) + 4
    for tick in (0.0, 25.0, 50.0, 75.0, 100.0):
        svg.line((x(tick), 4), (x(tick), bottom), "axis")
        svg.text(x(tick), bottom + 15, f"{tick:.0f}", "small soft", "middle")
    for row, (name, value, style) in enumerate(rows):
        y = step * row + 14
        svg.text(left - 10, y + 4, name, "bold" if name == "both" else "", "end")
        svg.line((x(0.0), y), (x(value), y), "zero")
        svg.circle((x(value), y), 5, style)
        svg.text(width, y + 4, rate(value), "bold" if name == "both" else "", "end")
    return svg
