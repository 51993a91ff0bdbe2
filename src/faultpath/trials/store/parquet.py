"""Rows to Parquet bytes and back: the only file that talks to pyarrow.

The bytes depend on the rows and on the version of pyarrow alone.
"""

# pyarrow ships no types.
# pyright: reportMissingTypeStubs=false, reportUnknownMemberType=false
# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import pyarrow as pa
import pyarrow.parquet as pq

from faultpath.core.files.opening import opened

TEXT, INTEGER, NUMBER = pa.string(), pa.int64(), pa.float64()
NUMBERS = pa.list_(pa.float32())

Schema: TypeAlias = Mapping[str, Any]
"""Columns by name, each with one of the types above."""
Row: TypeAlias = Mapping[str, Any]


class Unreadable(Exception):
    """The bytes are no Parquet file, or not one with the columns asked for."""


def encode(schema: Schema, rows: Iterable[Row], notes: Mapping[str, str] | None = None) -> bytes:
    """Return a Parquet file with these columns of `rows`, and `notes` in its metadata."""
    columns: dict[str, list[Any]] = {name: [] for name in schema}
    for row in rows:
        for name, values in columns.items():
            values.append(row[name])
    table = pa.table({name: pa.array(columns[name], type=kind) for name, kind in schema.items()})
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


def rows_in(path: Path) -> int:
    """Return how many rows a Parquet file has, from its footer; `Unreadable` for anything else."""
    try:
        with opened(path) as file:
            return pq.read_metadata(file).num_rows
    except (pa.ArrowException, OSError) as error:
        raise Unreadable(str(error)) from error


def numbers_in(data: bytes) -> list[str]:
    """Return the columns of a Parquet file that hold numbers; `Unreadable` for anything else."""
    try:
        schema = pq.read_schema(pa.BufferReader(data))
    except (pa.ArrowException, OSError) as error:
        raise Unreadable(str(error)) from error
    return [field.name for field in schema if field.type == NUMBER]


def decode(
    data: bytes, schema: Schema, may_lack: Collection[str] = ()
) -> tuple[Iterator[dict[str, Any]], dict[str, str]]:
    """Return the rows of a Parquet file and its notes.

    `Unreadable` when it has not got the columns of `schema`, or one has gaps that is not among
    those that `may_lack` values.
    """
    try:
        table = read_table(data)
    except (pa.ArrowException, OSError) as error:
        raise Unreadable(str(error)) from error
    columns: list[list[Any]] = []
    for name, kind in schema.items():
        if name not in table.column_names:
            raise Unreadable(f"there is no column {name!r}")
        column = table.column(name)
        if column.type != kind:
            raise Unreadable(f"a column is {column.type}, not {kind}")
        if column.null_count and name not in may_lack:
            raise Unreadable(f"column {name!r} has gaps")
        if kind is NUMBERS:
            columns.append([each.values.to_numpy() if each.is_valid else None for each in column])
        else:
            columns.append(column.to_pylist())
    rows = (dict(zip(schema, row, strict=True)) for row in zip(*columns, strict=True))
    notes = table.schema.metadata or {}
    return rows, {key.decode(): text.decode() for key, text in notes.items()}
