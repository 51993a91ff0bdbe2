"""Columns to Parquet bytes and back: the only file that talks to pyarrow.

The bytes depend on the columns and on the version of pyarrow alone.
"""

# pyarrow ships no types.
# pyright: reportMissingTypeStubs=false, reportUnknownMemberType=false
# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

Values = Sequence[Any]


class Kind(Enum):
    """The types that a column may have; each may hold null."""

    TEXT = pa.string()
    INTEGER = pa.int64()
    NUMBER = pa.float64()
    NUMBERS = pa.list_(pa.float32())


@dataclass(frozen=True)
class Column:
    """A column's name and type."""

    name: str
    kind: Kind


class Unreadable(Exception):
    """The bytes are no Parquet file, or not one with the columns asked for."""


def encode(
    columns: Sequence[Column], values: Mapping[str, Values], notes: Mapping[str, str] | None = None
) -> bytes:
    """Return a Parquet file with these columns, in this order, and `notes` in its metadata."""
    arrays = [pa.array(values[column.name], type=column.kind.value) for column in columns]
    table = pa.table(arrays, names=[column.name for column in columns])
    if notes:
        table = table.replace_schema_metadata(dict(notes))
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd")
    return sink.getvalue().to_pybytes()


def read_table(data: bytes) -> pa.Table:
    """Return the table in a Parquet file's bytes; raises pyarrow's errors or `OSError`.

    In this thread alone: a thread of pyarrow's that still lets go of `data` while the interpreter
    shuts down ends the process with an abort.
    """
    return pq.ParquetFile(pa.BufferReader(data), pre_buffer=False).read(use_threads=False)


def decode(data: bytes, columns: Sequence[Column]) -> dict[str, list[Any]]:
    """Return these columns of a Parquet file; `Unreadable` when it has not got them."""
    return decode_noted(data, columns)[0]


def decode_noted(
    data: bytes, columns: Sequence[Column]
) -> tuple[dict[str, list[Any]], dict[str, str]]:
    """Return these columns of a Parquet file and its notes; `Unreadable` as `decode`."""
    try:
        table = read_table(data)
    except (pa.ArrowException, OSError) as error:
        raise Unreadable(str(error)) from error
    out: dict[str, list[Any]] = {}
    for column in columns:
        if column.name not in table.column_names:
            raise Unreadable(f"there is no column {column.name!r}")
        out[column.name] = _values(table.column(column.name), column.kind)
    notes = table.schema.metadata or {}
    return out, {key.decode(): text.decode() for key, text in notes.items()}


def _values(column: Any, kind: Kind) -> list[Any]:
    if column.type != kind.value:
        raise Unreadable(f"a column is {column.type}, not {kind.value}")
    if kind is not Kind.NUMBERS:
        return column.to_pylist()
    return [scalar.values.to_numpy() if scalar.is_valid else None for scalar in column]
