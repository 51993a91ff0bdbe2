"""Base classes of data models; a console shows a result in one line."""

from pydantic import BaseModel, ConfigDict

from faultpath.core.text import printable, shortened

_LINE, _CELL = 160, 80
"""Letters of a line and of a cell."""


class Frozen(BaseModel):
    """Immutable data without further fields."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Shown(BaseModel):
    """Data with many fields, of which a console shows some."""

    def __repr__(self) -> str:
        """Return the fields that are not empty."""
        line = ", ".join(
            f"{name}={shortened(printable(str(value)), _CELL)}"
            for name, value in self
            if value not in (None, (), {}, "")
        )
        return f"<{type(self).__name__}: {shortened(line, _LINE)}>"

    __str__ = __repr__


class Result(Shown, Frozen):
    """A part of a result: immutable, and one line in a console."""
