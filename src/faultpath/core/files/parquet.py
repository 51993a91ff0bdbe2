"""Parquet files from rows and back; no other module uses pyarrow.

The bytes depend only on the rows and on pyarrow's version.
"""

# pyarrow ships no types.
# pyright: reportMissingTypeStubs=false, reportUnknownMemberType=false
# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false
from collections.abc import Collection, Generator, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, TypeAlias

import pyarrow as pa
import pyarrow.parquet as pq

from faultpath.core.files.opening import most_unpacked

TEXT, INTEGER, NUMBER = pa.string(), pa.int64(), pa.float64()
NUMBERS = pa.list_(pa.float32())

Schema: TypeAlias = Mapping[str, Any]
"""Columns by name, each with one of the types above."""
Row: TypeAlias = Mapping[str, Any]


class Unreadable(Exception):
    """The bytes are no Parquet file, or not one with the columns asked for."""


def encode(schema: Schema, rows: Iterable[Row], notes: Mapping[str, str] | None = None) -> bytes:
    """Return a Parquet file of `rows` and `notes`; a cell is empty where a row lacks the column."""
    columns: dict[str, list[Any]] = {name: [] for name in schema}
    for row in rows:
        for name, values in columns.items():
            values.append(row.get(name))
    return encode_columns(schema, columns, notes)


def encode_columns(
    schema: Schema, columns: Mapping[str, Any], notes: Mapping[str, str] | None = None
) -> bytes:
    """Return a Parquet file of `notes` and `columns`, sequences or arrays of one length."""
    table = pa.table({name: pa.array(columns[name], type=kind) for name, kind in schema.items()})
    if notes:
        table = table.replace_schema_metadata(dict(notes))
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd")
    return sink.getvalue().to_pybytes()


def masked(values: Any) -> Any:
    """Return an array of numbers as a column that is empty where the array holds NaN."""
    return pa.array(values, type=NUMBER, from_pandas=True)


@contextmanager
def _as_unreadable() -> Generator[None]:
    """Turn any error that a damaged file causes in pyarrow into `Unreadable`."""
    try:
        yield
    except MemoryError:
        raise Unreadable("it asks for more memory than there is") from None
    except (pa.ArrowException, OSError, ValueError, OverflowError) as error:
        raise Unreadable(str(error)) from error


@_as_unreadable()
def read_table(data: bytes) -> pa.Table:
    """Return the table of a Parquet file; `Unreadable` for another file or too large a one."""
    for _ in _batches(data):
        pass
    return pq.ParquetFile(pa.BufferReader(data), pre_buffer=False).read(use_threads=False)


def _batches(data: bytes) -> Iterator[pa.RecordBatch]:
    """Yield the rows until they take too much memory, since equal values are packed to nothing.

    No threads: one of pyarrow's that still releases data while the interpreter shuts down would
    abort the process.
    """
    file = pq.ParquetFile(pa.BufferReader(data), pre_buffer=False)
    if len(set(names := file.schema_arrow.names)) < len(names):
        raise Unreadable("two columns have one name")
    metadata, most, unpacked = file.metadata, most_unpacked(len(data)), 0
    groups = (metadata.row_group(number) for number in range(metadata.num_row_groups))
    cells = sum(group.column(n).num_values for group in groups for n in range(group.num_columns))
    least = 16 * cells  # bytes as Python objects
    for batch in file.iter_batches(256, use_threads=False) if least <= most else ():
        for column in batch:
            plain = isinstance(column, pa.DictionaryArray) and column.dictionary_decode()
            unpacked += (plain or column).nbytes
        if unpacked > most:
            break
        yield batch
    if max(least, unpacked) > most:
        raise Unreadable(f"it unpacks to more than {most / 2**20:.0f} MiB")


def read_rows(data: bytes) -> Iterator[tuple[int, dict[str, Any]]]:
    """Yield the rows of any Parquet file, numbered from one; `Unreadable` for another file.

    Columns may be of any types.
    """
    number = 0
    with _as_unreadable():
        for batch in _batches(data):
            for row in batch.to_pylist():
                yield (number := number + 1), row


@_as_unreadable()
def decode(
    data: bytes,
    schema: Schema,
    may_lack: Collection[str] = (),
    more: Any = None,
    absent: Collection[str] = (),
) -> tuple[Iterator[dict[str, Any]], dict[str, str]]:
    """Return the rows of a Parquet file and its notes; `Unreadable` where they do not fit.

    Rows have the columns of `schema`, and all others of the type `more`, which may have gaps. A
    column of `schema` may only have gaps if it is in `may_lack`, and only be missing if it is in
    `absent`: it then holds `None`.
    """
    table = read_table(data)
    others = [f.name for f in table.schema if f.type == more and f.name not in schema]
    kinds = {**schema, **dict.fromkeys(others, more)}
    columns: list[list[Any]] = []
    for name, kind in kinds.items():
        if name not in table.column_names:
            if name in absent:
                columns.append([None] * table.num_rows)
                continue
            raise Unreadable(f"there is no column {name!r}")
        column = table.column(name)
        if column.type != kind:
            raise Unreadable(f"a column is {column.type}, not {kind}")
        if column.null_count and name not in (*may_lack, *others):
            raise Unreadable(f"column {name!r} has gaps")
        if kind is NUMBERS:
            columns.append([cell.values.to_numpy() if cell.is_valid else None for cell in column])
        else:
            columns.append(column.to_pylist())
    rows = (dict(zip(kinds, row, strict=True)) for row in zip(*columns, strict=True))
    notes = table.schema.metadata or {}
    return rows, {key.decode(): text.decode() for key, text in notes.items()}
