"""Pictures as SVG, and their axes; text and attribute values are escaped on the way in."""

import math
from collections.abc import Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from hashlib import blake2b
from importlib import resources
from unicodedata import east_asian_width

from markupsafe import Markup

from faultpath.report.escapes import html as escape

Point = tuple[float, float]

# Advance widths of wide sans serifs (thousandths of the size), none of them less than DejaVu's:
# labels are placed by them, and a label that is narrower than foretold overlaps nothing.
_THIN = dict.fromkeys("ilj'", 290) | dict.fromkeys("I.,:;|", 340)
_NARROW = dict.fromkeys('ft()[]/-r "!', 415) | dict.fromkeys("cksz", 580)
_DIGITS = dict.fromkeys("0123456789", 640)  # they have one width, and a wide one in some fonts
_WIDE = dict.fromkeys("mwMW%@→−+=<>≤≥…", 1000) | dict.fromkeys("ABCDEFGHKNOPQRSTUVXYZ&", 790)
_ADVANCE = _THIN | _NARROW | _DIGITS | _WIDE
BOLD = 1.1
"""How much wider bold letters are."""
_SIZES = {"small": 11.0, "head": 13.0 * BOLD, "bold": 12.0 * BOLD}
"""Sizes of text by its class, in pixels, as `svg.css` has them and as wide; 12 otherwise."""


def text_width(text: str, size: float) -> float:
    """Return a safe estimate of how wide `text` is at `size` pixels."""
    return sum(_ADVANCE.get(c, 1000 if east_asian_width(c) in "WF" else 640) for c in text) * (
        size / 1000.0
    )


def shortened(text: str, width: float, size: float) -> str:
    """Return `text`, cut with an ellipsis where it would be wider than `width` pixels."""
    if text_width(text, size) <= width:
        return text
    kept = text
    while kept and text_width(kept + "…", size) > width:
        kept = kept[:-1]
    return kept.rstrip(" ._-") + "…"


@cache
def template(name: str, package: str = "faultpath.report") -> str:
    """Return the text of a file in the folder `templates` of a package."""
    return resources.files(package).joinpath("templates", name).read_text("utf-8")


def number(value: float) -> str:
    """Return a coordinate with at most two decimals."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


_FILE_MARGIN = 16


class Svg:
    """One picture. Its size is in pixels at scale 1; on a page it scales with its column."""

    def __init__(
        self, width: float, height: float, title: str, description: str = "", role: str = "img"
    ) -> None:
        self.width, self.height, self._role = width, height, role
        content = f"{title}\0{description}\0{width}\0{height}".encode(errors="backslashreplace")
        self.uid = f"fig-{blake2b(content, digest_size=6).hexdigest()}"
        self._title, self._description = title, description
        self._parts: list[str] = []

    def _add(self, tag: str, cls: str, inner: str, **attributes: float | str) -> None:
        self._parts.append(f"<{tag}{_attributes(cls, attributes)}>{inner}</{tag}>")

    def line(self, a: Point, b: Point, cls: str) -> None:
        """Draw a straight line from `a` to `b`."""
        self._add("line", cls, "", x1=a[0], y1=a[1], x2=b[0], y2=b[1])

    def rect(
        self, x: float, y: float, w: float, h: float, cls: str, r: float = 0, tip: str = ""
    ) -> None:
        """Draw a rectangle with its upper left corner at `(x, y)` and corner radius `r`."""
        self._add("rect", cls, _tip(tip), x=x, y=y, width=max(w, 0.0), height=max(h, 0.0), rx=r)

    def circle(self, at: Point, r: float, cls: str, tip: str = "") -> None:
        """Draw a disc."""
        self._add("circle", cls, _tip(tip), cx=at[0], cy=at[1], r=r)

    def path(self, d: str, cls: str, **attributes: str) -> None:
        """Draw a path given in SVG's own notation."""
        self._add("path", cls, "", d=d, **attributes)

    def polygon(self, points: Sequence[Point], cls: str, tip: str = "") -> None:
        """Draw a closed polygon."""
        self._add("polygon", cls, _tip(tip), points=_joined(points))

    def polyline(self, points: Sequence[Point], cls: str) -> None:
        """Draw an open line through `points`."""
        self._add("polyline", cls, "", points=_joined(points))

    def text(
        self,
        x: float,
        y: float,
        content: str,
        cls: str = "",
        anchor: str = "",
        tip: str = "",
        room: float | None = None,
    ) -> None:
        """Write `content` with its baseline at `y`; `anchor` is start, middle or end.

        What is wider than `room` is cut, and the whole is a tip. What would stick out of the
        picture at a side is moved in, as far as the other allows.
        """
        size = next((_SIZES[name] for name in cls.split() if name in _SIZES), 12.0)
        if room is not None:
            tip = tip or content
            content = shortened(content, room, size)
        width = text_width(content, size)
        before = {"middle": width / 2, "end": width}.get(anchor, 0.0)
        inside = min(max(x, before), max(self.width - width, 0.0) + before)
        attributes: dict[str, float | str] = {"x": inside, "y": y}
        if anchor:
            attributes["text-anchor"] = anchor
        self._add("text", cls, escape(content) + _tip(tip), **attributes)

    @contextmanager
    def group(
        self, cls: str = "", tip: str = "", link: str = "", **attributes: str
    ) -> Generator[None]:
        """Put what is drawn inside into one `<g>`, or into one link."""
        tag, to = ("a", {"href": link}) if link else ("g", {})
        self._parts.append(f"<{tag}{_attributes(cls, {**to, **attributes})}>{_tip(tip)}")
        yield
        self._parts.append(f"</{tag}>")

    def hatch(self, name: str, cls: str, spacing: float) -> str:
        """Define a diagonal hatching and return the `fill` that uses it."""
        key, step = f"{self.uid}-{name}", number(spacing)
        self._parts.append(
            f'<defs><pattern id="{key}" width="{step}" height="{step}" '
            'patternUnits="userSpaceOnUse" patternTransform="rotate(45)">'
            f'<line x1="0" y1="0" x2="0" y2="{step}" class="{escape(cls)}"/></pattern></defs>'
        )
        return f"url(#{key})"

    def clip(self, name: str, low: Point, high: Point, cls: str) -> str:
        """Define a rectangle by two corners and return the `clip-path` that shows only it."""
        key, (left, top), (right, bottom) = f"{self.uid}-{name}", low, high
        self._parts.append(
            f'<defs><clipPath id="{key}"><rect class="{escape(cls)}" x="{number(left)}" '
            f'y="{number(top)}" width="{number(right - left)}" height="{number(bottom - top)}"/>'
            "</clipPath></defs>"
        )
        return f"url(#{key})"

    def render(self, standalone: bool = False) -> Markup:
        """Return the markup, which is safe on a page; `standalone` carries its own style and opens
        as a file."""
        style, margin = "", 0
        if standalone:
            margin = _FILE_MARGIN
            css = template("tokens.css") + template("svg.css")
            ground = f'<rect class="paper" x="-{margin}" y="-{margin}" width="100%" height="100%"/>'
            style = f"<style>{css}</style>{ground}"
        width, height = number(self.width + 2 * margin), number(self.height + 2 * margin)
        ids, described = f"{self.uid}-t", ""
        if self._description:
            ids += f" {self.uid}-d"
            described = f'<desc id="{self.uid}-d">{escape(self._description)}</desc>'
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" class="fig" role="{self._role}" '
            f'aria-labelledby="{ids}" viewBox="{-margin} {-margin} {width} {height}" '
            f'width="{width}" height="{height}">'
            f'<title id="{self.uid}-t">{escape(self._title)}</title>{described}{style}'
        )
        return Markup(head + "".join(self._parts) + "</svg>")


def _tip(text: str) -> str:
    return f"<title>{escape(text)}</title>" if text else ""


def _joined(points: Sequence[Point]) -> str:
    return " ".join(f"{number(x)},{number(y)}" for x, y in points)


def _attributes(cls: str, attributes: Mapping[str, float | str]) -> str:
    named = {"class": cls, **attributes} if cls else attributes
    return "".join(
        f' {key.replace("_", "-")}="{escape(value) if isinstance(value, str) else number(value)}"'
        for key, value in named.items()
    )


@dataclass(frozen=True)
class Axis:
    """Maps data from `low..high` to pixels from `start` to `end`."""

    low: float
    high: float
    start: float = 0.0
    end: float = 1.0

    def __call__(self, value: float) -> float:
        """Return the pixel of a value."""
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    def ticks(self, about: int) -> list[float]:
        """Return round numbers inside the axis, roughly `about` of them."""
        raw = (self.high - self.low) / about
        power = 10.0 ** math.floor(math.log10(raw))
        step = power * next(m for m in (1.0, 2.0, 5.0, 10.0) if raw <= m * power * 1.0001)
        first = math.ceil(self.low / step - 1e-9)
        last = math.floor(self.high / step + 1e-9)
        return [i * step for i in range(first, last + 1)]

    def at(self, start: float, end: float) -> "Axis":
        """Return the same data range over other pixels."""
        return Axis(self.low, self.high, start, end)


def covering(values: Iterable[float], margin: float = 0.06, least: float = 1.0) -> Axis:
    """Return an axis from 0 to 1 pixel that covers 0 and every value, with a margin."""
    inside = [0.0, *(max(-1e300, min(value, 1e300)) for value in values)]  # sums of them are finite
    low, high = min(inside), max(inside)
    if high - low < least:
        middle = 0.5 * (low + high)
        low, high = middle - 0.5 * least, middle + 0.5 * least
    pad = margin * (high - low)
    return Axis(low - pad, high + pad)


SHADES = ((30.0, "0.62"), (10.0, "0.42"), (0.0, "0.22"))
"""From which difference on, pp, an area has which opacity."""


def shade(difference: float) -> str:
    """Return the opacity of an area that shows a difference, pp."""
    return next(opacity for least, opacity in SHADES if abs(difference) >= least)


def draw_scale(svg: Svg, width: float, hatch: str = "") -> None:
    """Draw a piece for each shade of the baseline, hatched, and of the repair, with labels between
    the pieces."""
    shades = [opacity for _, opacity in SHADES]
    for column, opacity in enumerate((*shades, *reversed(shades))):
        side = "baseline-only" if column < len(shades) else "repair-only"
        piece = f"M{number(column * width)} 38h{number(width)}v12h-{number(width)}Z"
        svg.path(piece, side, fill_opacity=opacity)
        if hatch and column < len(shades):
            svg.path(piece, "", fill=hatch, fill_opacity="0.5")
    for column, label in enumerate(("−30", "−10", "0", "+10", "+30"), 1):
        svg.text(column * width, 63, label, "small soft", "middle")


def draw_band(svg: Svg, points: Iterable[tuple[float, float, float]], cls: str = "fan") -> None:
    """Fill between a lower and an upper line, given as `(x, lower, upper)` in pixels."""
    x, lower, upper = zip(*points, strict=True)
    svg.polygon([*zip(x, upper, strict=True), *reversed([*zip(x, lower, strict=True)])], cls)


def tick_label(value: float) -> str:
    """Return a short label with a real minus sign."""
    return f"{round(value, 9):g}".replace("-", "−")


def draw_axes(
    svg: Svg, x: Axis, y: Axis, levels: int, ticks: Iterable[float] = (), zero: str = "zero"
) -> None:
    """Draw about `levels` round levels of the upward axis across the plot, labels to their left,
    and `ticks` of the lower axis with their labels below."""
    for tick in y.ticks(levels):
        svg.line((x.start, y(tick)), (x.end, y(tick)), zero if tick == 0 else "axis")
        svg.text(x.start - 6, y(tick) + 4, tick_label(tick), "small soft", "end")
    for tick in ticks:
        svg.line((x(tick), y.start), (x(tick), y.start + 4), "axis")
        svg.text(x(tick), y.start + 17, tick_label(tick), "small soft", "middle")
