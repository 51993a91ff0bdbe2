"""Logs as they lie in files: named columns, each with its times."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np
import pyarrow as pa
import pyarrow.csv as csv
import pyarrow.parquet as pq
from numpy.typing import NDArray

from faultpath.errors import UserError
from faultpath.files.opening import contents
from faultpath.flightlog.columns import TIME_UNITS, ColumnMap
from faultpath.text import extra, one_line, unknown

Floats: TypeAlias = NDArray[np.float64]
_LONGEST_S = 1e12
"""A time of more seconds is no time; those since 1970 are a thousandth of it."""
_LARGEST = 1e9
"""A million metres a second, in the smallest unit."""


@dataclass(frozen=True)
class Series:
    """One column: times in s, ascending, and values, all finite."""

    time_s: Floats
    values: Floats


def read_series(path: Path, columns: ColumnMap) -> Mapping[str, Series]:
    """Return the columns that the map names.

    Raises `UserError` for a file that cannot be read, a column that it does not have or that holds
    no numbers, and times that do not ascend or cannot be of that unit.
    """
    kind = path.suffix.lower()
    readers = {".csv": _table, ".parquet": _table, ".ulg": _ulog}
    if kind not in readers:
        raise UserError(f"{path}: is not a .csv, .parquet or .ulg file: convert it to one")
    return {
        name: _checked(path, name, time_s, values)
        for name, (time_s, values) in readers[kind](path, columns).items()
    }


def _table(path: Path, columns: ColumnMap) -> dict[str, tuple[Floats, Floats]]:
    try:
        parquet = path.suffix.lower() == ".parquet"
        data = BytesIO(contents(path))
        table: pa.Table = cast(Any, pq.ParquetFile(data)).read() if parquet else csv.read_csv(data)
    except (OSError, pa.ArrowException) as error:
        raise UserError(f"{path}: cannot be read ({_why(error)}): give a whole log") from None
    if columns.time is None:
        raise UserError(f"{path}: the map names no time column: add time: {{column: …, unit: s}}")
    found = {name: _numbers(path, name, table) for name in (columns.time.column, *columns.names)}
    time_s = found[columns.time.column] * TIME_UNITS[columns.time.unit]
    return {name: (time_s, found[name]) for name in columns.names}


def _numbers(path: Path, name: str, table: pa.Table) -> Floats:
    if name not in table.column_names:
        raise UserError(f"{path}: {unknown('column', name, table.column_names)}")
    if table.column_names.count(name) > 1:
        raise UserError(f"{path}: two columns are called '{name}': give each a name of its own")
    kind: Any = table[name].type
    try:
        if pa.types.is_boolean(kind):
            raise pa.ArrowInvalid
        return table[name].cast(pa.float64()).to_numpy()
    except pa.ArrowException:
        raise UserError(
            f"{path}: column '{name}' holds {kind} and no numbers: name another, or correct it"
        ) from None


def _ulog(path: Path, columns: ColumnMap) -> dict[str, tuple[Floats, Floats]]:
    try:
        # It ships no types.
        from pyulog import ULog  # pyright: ignore[reportMissingTypeStubs]
    except ImportError:
        raise UserError(
            f"reading .ulg files needs pyulog, not installed here: {extra('ulog')}"
        ) from None
    topics = sorted({name.partition(".")[0] for name in columns.names})
    try:
        log = cast(Any, ULog(BytesIO(contents(path)), topics))
        data = cast(Sequence[Any], log.data_list)
    except Exception as error:  # pyulog raises whatever a damaged file leads it into
        raise UserError(
            f"{path}: cannot be read as a ULog file ({_why(error)}): give a whole log"
        ) from None
    messages: dict[str, dict[str, Any]] = {
        each.name: each.data for each in reversed(data)
    }  # the first instance stays
    found: dict[str, tuple[Floats, Floats]] = {}
    for name in columns.names:
        topic, _, field = name.partition(".")
        if topic not in messages:
            raise UserError(f"{path}: {unknown('message', topic, sorted(messages))}")
        if field not in messages[topic]:
            raise UserError(f"{path}: {unknown('field', name, sorted(messages[topic]))}")
        if "timestamp" not in messages[topic]:
            raise UserError(f"{path}: message '{topic}' has no timestamp: record it with its times")
        time_s = np.asarray(messages[topic]["timestamp"], dtype=np.float64) * TIME_UNITS["us"]
        found[name] = time_s, np.asarray(messages[topic][field], dtype=np.float64)
    return found


def _why(error: Exception) -> str:
    said = (error.strerror if isinstance(error, OSError) else "") or str(error)
    return one_line(said) or type(error).__name__


def _checked(path: Path, name: str, time_s: Floats, values: Floats) -> Series:
    for what, found, most in (("times", time_s, _LONGEST_S), ("values", values, _LARGEST)):
        if (odd := np.flatnonzero(np.abs(found) > most)).size:  # infinite ones too
            raise UserError(
                f"{path}: the {what} of column '{name}' reach {found[odd[0]]:g} at its reading "
                f"{odd[0]}, which no flight does: correct the log, or leave the cell empty"
            )
    there = np.isfinite(time_s) & np.isfinite(values)  # what is empty is not a number
    time_s, values = time_s[there], values[there]
    if len(time_s) < 2:
        raise UserError(f"{path}: column '{name}' has fewer than two numbers: name another")
    if (np.diff(time_s) < 0).any():
        row = int(np.flatnonzero(np.diff(time_s) < 0)[0]) + 1
        raise UserError(
            f"{path}: the times of column '{name}' go back at its reading {row}: sort the rows, or "
            "name the column of time"
        )
    time_s, first = np.unique(time_s, return_index=True)
    rate_hz = (len(time_s) - 1) / max(float(time_s[-1] - time_s[0]), 1e-9)
    if not 2 <= rate_hz <= 20_000:
        raise UserError(
            f"{path}: column '{name}' has {rate_hz:.3g} readings a second, which no flight log "
            "has: correct the unit of time"
        )
    return Series(time_s, values[first])
