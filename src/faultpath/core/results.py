"""How results look in a console and in a notebook: a line."""

from pydantic import BaseModel

from faultpath.core.frozen import Frozen
from faultpath.core.text import printable

_LINE, _CELL = 160, 80
"""Letters of a line and of a cell."""


class Shown(BaseModel):
    """Data with many fields, of which a console shows the headline or some."""

    def __repr__(self) -> str:
        """Return the headline where there is one, else the fields that say something."""
        said = getattr(getattr(self, "verdict", self), "headline", "")
        said = said or ", ".join(
            f"{name}={_cut(printable(str(value)), _CELL)}"
            for name, value in self
            if value not in (None, (), {}, "")
        )
        return f"<{type(self).__name__}: {_cut(said, _LINE)}>"

    __str__ = __repr__


class Result(Shown, Frozen):
    """A part of a result: data that nobody changes."""


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else f"{text[: most - 1]}…"
