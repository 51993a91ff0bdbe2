"""A small SVG writer: everything that is text or an attribute value is escaped on the way in."""

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from functools import cache
from hashlib import blake2b
from importlib import resources

from faultpath.tables.escapes import html as escape

Point = tuple[float, float]

# Advance widths of a common sans serif (thousandths of the size), a little on the wide side: labels
# are placed by them, and a label that is narrower than foretold overlaps nothing.
_NARROW = dict.fromkeys("iljI.,:;'|!", 290) | dict.fromkeys('ft()[]/-r "', 350)
_DIGITS = dict.fromkeys("0123456789", 640)  # they have one width, and a wide one in some fonts
_WIDE = dict.fromkeys("mwMW%@→−+=<>", 880) | dict.fromkeys("ABCDEFGHKNOPQRSTUVXYZ&", 720)
_ADVANCE = _NARROW | _DIGITS | _WIDE
_SIZES = {"small": 11.0, "tiny": 10.0, "on-tag": 10.0, "head": 13.0, "rate": 17.0}
"""Of text by its class, in pixels, as `svg.css` has them; 12 otherwise."""


def text_width(text: str, size: float) -> float:
    """Return a safe estimate of how wide `text` is at `size` pixels."""
    return sum(_ADVANCE.get(c, 580) for c in text) * size / 1000.0


def shortened(text: str, width: float, size: float) -> str:
    """Return `text`, cut with an ellipsis where it would be wider than `width` pixels."""
    if text_width(text, size) <= width:
        return text
    kept = text
    while kept and text_width(kept + "…", size) > width:
        kept = kept[:-1]
    return kept.rstrip(" ._-") + "…"


def wrapped(text: str, width: float, size: float, lines: int) -> list[str]:
    """Break `text` at spaces into at most `lines` lines, the last one shortened to fit."""
    done: list[str] = []
    line = ""
    words = text.split()
    for position, word in enumerate(words):
        longer = f"{line} {word}".strip()
        if text_width(longer, size) <= width or not line:
            line = longer
            continue
        if len(done) == lines - 1:
            return [*done, shortened(" ".join([line, *words[position:]]), width, size)]
        done.append(line)
        line = word
    return [*done, shortened(line, width, size)]


@cache
def template(name: str) -> str:
    """Return the text of a file in `faultpath/report/templates`."""
    return resources.files("faultpath.report").joinpath("templates", name).read_text("utf-8")


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

    def _add(self, tag: str, cls: str, tip: str | None, **attributes: float | str) -> None:
        inner = f"<title>{escape(tip)}</title>" if tip else ""
        self._parts.append(f"<{tag}{_attributes(cls, attributes)}>{inner}</{tag}>")

    def line(self, a: Point, b: Point, cls: str) -> None:
        """Draw a straight line from `a` to `b`."""
        self._add("line", cls, None, x1=a[0], y1=a[1], x2=b[0], y2=b[1])

    def rect(
        self, x: float, y: float, w: float, h: float, cls: str, r: float = 0, tip: str | None = None
    ) -> None:
        """Draw a rectangle with its upper left corner at `(x, y)` and corner radius `r`."""
        self._add("rect", cls, tip, x=x, y=y, width=max(w, 0.0), height=max(h, 0.0), rx=r)

    def circle(self, at: Point, r: float, cls: str, tip: str | None = None) -> None:
        """Draw a disc."""
        self._add("circle", cls, tip, cx=at[0], cy=at[1], r=r)

    def path(self, d: str, cls: str, tip: str | None = None, **attributes: str) -> None:
        """Draw a path given in SVG's own notation."""
        self._add("path", cls, tip, d=d, **attributes)

    def polygon(self, points: Sequence[Point], cls: str, tip: str | None = None) -> None:
        """Draw a closed polygon."""
        self._add("polygon", cls, tip, points=_joined(points))

    def polyline(self, points: Sequence[Point], cls: str) -> None:
        """Draw an open line through `points`."""
        self._add("polyline", cls, None, points=_joined(points))

    def text(
        self, x: float, y: float, content: str, cls: str = "", anchor: str = "", tip: str = ""
    ) -> None:
        """Write `content` with its baseline at `y`; `anchor` is start, middle or end.

        What would stick out of the picture at a side is moved in, as far as the other allows.
        """
        size = next((_SIZES[name] for name in cls.split() if name in _SIZES), 12.0)
        width = text_width(content, size)
        before = {"middle": width / 2, "end": width}.get(anchor, 0.0)
        inside = min(max(x, before), max(self.width - width, 0.0) + before)
        attributes: dict[str, float | str] = {"x": inside, "y": y}
        if anchor:
            attributes["text-anchor"] = anchor
        inner = escape(content) + (f"<title>{escape(tip)}</title>" if tip else "")
        self._parts.append(f"<text{_attributes(cls, attributes)}>{inner}</text>")

    @contextmanager
    def group(
        self, cls: str = "", tip: str | None = None, link: str = "", **attributes: str
    ) -> Generator[None]:
        """Put what is drawn inside into one `<g>`, or into one link."""
        inner = f"<title>{escape(tip)}</title>" if tip else ""
        tag, to = ("a", {"href": link}) if link else ("g", {})
        self._parts.append(f"<{tag}{_attributes(cls, to | attributes)}>{inner}")
        yield
        self._parts.append(f"</{tag}>")

    def hatch(self, name: str, cls: str, spacing: float = 5) -> str:
        """Define a diagonal hatching and return the `fill` that uses it."""
        key = f"{self.uid}-{name}"
        self._parts.append(
            f'<defs><pattern id="{key}" width="{number(spacing)}" height="{number(spacing)}" '
            'patternUnits="userSpaceOnUse" patternTransform="rotate(45)">'
            f'<line x1="0" y1="0" x2="0" y2="{number(spacing)}" class="{escape(cls)}"/>'
            "</pattern></defs>"
        )
        return f"url(#{key})"

    def filled(self, x: float, y: float, w: float, h: float, fill: str) -> None:
        """Draw a rectangle filled with a pattern from `hatch`."""
        self._add("rect", "", None, x=x, y=y, width=max(w, 0.0), height=h, fill=fill)

    def render(self, standalone: bool = False) -> str:
        """Return the markup; `standalone` carries its own style and opens as a file."""
        style, margin = "", 0
        if standalone:
            margin = _FILE_MARGIN
            css = template("tokens.css") + template("svg.css")
            ground = f'<rect class="paper" x="-{margin}" y="-{margin}" width="100%" height="100%"/>'
            style = f"<style>{css}</style>{ground}"
        width, height = number(self.width + 2 * margin), number(self.height + 2 * margin)
        ids = f"{self.uid}-t {self.uid}-d" if self._description else f"{self.uid}-t"
        described = (
            f'<desc id="{self.uid}-d">{escape(self._description)}</desc>'
            if self._description
            else ""
        )
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" class="fig" role="{self._role}" '
            f'aria-labelledby="{ids}" viewBox="{-margin} {-margin} {width} {height}" '
            f'width="{width}" height="{height}">'
            f'<title id="{self.uid}-t">{escape(self._title)}</title>{described}{style}'
        )
        return head + "".join(self._parts) + "</svg>"


def _joined(points: Sequence[Point]) -> str:
    return " ".join(f"{number(x)},{number(y)}" for x, y in points)


def _attributes(cls: str, attributes: dict[str, float | str] | dict[str, str]) -> str:
    named = {"class": cls, **attributes} if cls else attributes
    return "".join(
        f' {key.replace("_", "-")}="{escape(value) if isinstance(value, str) else number(value)}"'
        for key, value in named.items()
    )
