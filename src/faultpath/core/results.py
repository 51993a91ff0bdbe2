"""Base classes of data models; a console shows a result in one line."""

from collections.abc import Mapping
from typing import Any, Self

from pydantic import BaseModel, ConfigDict
from typing_extensions import override

from faultpath.core.text import printable, shortened

_LINE, _CELL = 160, 80
"""Characters of a line and of a field."""


class Frozen(BaseModel):
    """Immutable data without further fields."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @override
    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return a copy with other fields; `TypeError` for names that are no fields, which pydantic
        would add."""
        if unknown := set(update or ()) - set(type(self).model_fields):
            raise TypeError(f"{type(self).__name__} has no field {min(unknown)!r}")
        return super().model_copy(update=update, deep=deep)


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
