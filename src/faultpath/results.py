"""How results look in a console and in a notebook: a line, and tables."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any, cast

from pydantic import BaseModel

from faultpath.frozen import Frozen
from faultpath.text import printable

_LINE, _CELL, _ROWS = 160, 80, 20
"""Letters of a line and of a cell, and rows of a table that are shown."""


class Shown(BaseModel):
    """Data with many fields: a console shows some in a line, a notebook all as tables."""

    def __repr__(self) -> str:
        """Return the headline where there is one, else the fields that say something in a word."""
        verdict = getattr(self, "verdict", self)
        if headline := getattr(verdict, "headline", ""):
            return f"<{type(self).__name__}: {_cut(str(headline), _LINE)}>"
        said = ", ".join(f"{name}={_brief(value)}" for name, value in _fields(self) if _has(value))
        return f"<{type(self).__name__}: {_cut(said, _LINE)}>"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        return self.as_html()

    def as_html(self) -> str:
        """Return tables of the fields, each list of parts in one of its own."""
        several = {name: rows for name, value in _fields(self) if (rows := _rows(value))}
        plain = [(name, _brief(value)) for name, value in _fields(self) if name not in several]
        tables = [_table(("field", "value"), plain)] if plain else []
        for name, rows in several.items():
            columns = tuple(type(rows[0]).model_fields)
            cells = [tuple(_brief(getattr(row, each)) for each in columns) for row in rows[:_ROWS]]
            more = f", the first {_ROWS} of {len(rows)}" if len(rows) > _ROWS else ""
            tables.append(f"<p><b>{escape(name)}</b>{more}</p>{_table(columns, cells)}")
        return "".join(tables)


class Result(Shown, Frozen):
    """A part of a result: data that nobody changes."""


def _fields(model: BaseModel) -> list[tuple[str, Any]]:
    return [(name, getattr(model, name)) for name in type(model).model_fields]


def _has(value: object) -> bool:
    return value is not None and value != () and value != {} and value != ""


def _rows(value: object) -> list[BaseModel]:
    found = list(cast("Sequence[object]", value)) if isinstance(value, tuple | list) else []
    models = [each for each in found if isinstance(each, BaseModel)]
    same = {type(each) for each in models}
    return models if len(models) == len(found) and len(same) == 1 else []


def _brief(value: object) -> str:
    if isinstance(value, Mapping):
        named = cast("Mapping[object, object]", value)
        return _cut(", ".join(f"{key}: {_brief(each)}" for key, each in named.items()), _CELL)
    if isinstance(value, tuple | list):
        several = cast("Sequence[object]", value)
        if len(several) > 4 or any(isinstance(each, BaseModel) for each in several):
            return f"{len(several)} of them"
        return ", ".join(map(_brief, several))
    if value is None or isinstance(value, float):
        return "" if value is None else f"{value:.4g}"
    return _cut(printable(str(value)), _CELL)


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else f"{text[: most - 1]}…"


def _table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    head = "".join(f"<th>{escape(each)}</th>" for each in columns)
    body = "".join(
        f"<tr>{''.join(f'<td>{escape(each)}</td>' for each in row)}</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
