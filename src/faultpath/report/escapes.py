"""Text as HTML and Markdown show it: names are the user's, and markup is ours.

Both show what cannot be seen by its number, such as `[U+202E]`: control characters, the
marks that turn the direction of reading, and halves of characters that no file can hold.
"""

import re
from html import escape

_SPACE = str.maketrans("\t\n\r", "   ")

_UNSEEN = re.compile(
    "[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)

_MARKDOWN = str.maketrans(
    {c: f"\\{c}" for c in r"\`*_[]|#$~"} | {"<": "&lt;", ">": "&gt;", "&": "&amp;"}
)
_OPENING = re.compile(r"(?:[-+]|\d+[.)])(?= |$)|(?:-+|=+)$")
"""Text that opens a list, or makes a heading of the line before."""


def visible(text: str) -> str:
    """Return text in which what cannot be seen stands by its number."""
    return _UNSEEN.sub(lambda match: f"[U+{ord(match[0]):04X}]", text)


def unbroken(text: str) -> str:
    """Return text in which no line breaks between a number and its unit."""
    return re.sub(r"(?<=\d) (?=%|pp\b)", "\N{NO-BREAK SPACE}", text)


def html(text: str) -> str:
    """Return text that HTML and SVG show as it is, between tags and in quoted attributes."""
    return escape(visible(text))


def markdown(text: str) -> str:
    """Return text that Markdown shows as it is, in a cell or as a line; `$` opens no formula."""
    line = visible(text.translate(_SPACE)).strip(" ")
    opening = _OPENING.match(line)
    escaped = line.translate(_MARKDOWN)
    if not opening:
        return escaped
    return f"{escaped[: opening.end() - 1]}\\{escaped[opening.end() - 1 :]}"
