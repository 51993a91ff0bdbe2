"""How results look in a console and in a notebook: a line, and a table of their fields."""

from html import escape

from pydantic import BaseModel

from faultpath.core.frozen import Frozen
from faultpath.core.text import printable

_LINE, _CELL = 160, 80
"""Letters of a line and of a cell."""


class Shown(BaseModel):
    """Data with many fields: a console shows the headline or some of them, a notebook a table."""

    def __repr__(self) -> str:
        """Return the headline where there is one, else the fields that say something."""
        said = getattr(getattr(self, "verdict", self), "headline", "")
        said = said or ", ".join(f"{name}={text}" for name, text in self._texts() if text)
        return f"<{type(self).__name__}: {_cut(said, _LINE)}>"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        cells = (f"<td>{escape(name)}</td><td>{escape(text)}</td>" for name, text in self._texts())
        return f"<table>{''.join(f'<tr>{each}</tr>' for each in cells)}</table>"

    def _texts(self) -> list[tuple[str, str]]:
        return [
            (name, "" if value in (None, (), {}) else _cut(printable(str(value)), _CELL))
            for name, value in self
        ]


class Result(Shown, Frozen):
    """A part of a result: data that nobody changes."""


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else f"{text[: most - 1]}…"
