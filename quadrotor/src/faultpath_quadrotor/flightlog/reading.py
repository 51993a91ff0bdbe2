"""Logs as they lie in files: which columns hold what, in which units, and their readings."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from io import BytesIO
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias, cast

import numpy as np
import pyarrow as pa
import pyarrow.csv as csv
from pydantic import Field

from faultpath.plugin.data import Unreadable, read_table
from faultpath.plugin.system import Frozen, Misread, UserError, contents, read_yaml, unknown
from faultpath_quadrotor.flightlog.bags import SUFFIXES, Floats, read_bag, why

_LONGEST_S = 1e12
"""A time of more seconds is no time; those since 1970 are a thousandth of it."""
_LARGEST = 1e9
"""A million metres a second, in the smallest unit."""
_NO_BRACKETS = str.maketrans("[],", "   ")
HEAVIEST_KG = 1e6
Mass: TypeAlias = Annotated[float, Field(ge=1e-6, le=HEAVIEST_KG)]
Drag: TypeAlias = Annotated[float, Field(ge=1e-9, le=1e6)]
Factor: TypeAlias = Annotated[float, Field(ge=-1e9, le=1e9)]
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
SPEED_UNITS = {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3}
PX4 = "px4"
"""The map that ships, for ULog files of PX4."""


class TimeColumn(Frozen):
    """When a row was recorded; ULog files bring a time with every message, and need none.

    Of a bag the field of every message that says so; without one, when the bag recorded it.
    """

    column: str
    unit: Literal["s", "ms", "us", "ns"]


class Attitude(Frozen):
    """A unit quaternion from the body to the world."""

    columns: tuple[str, str, str, str]
    order: Literal["wxyz", "xyzw"]


class Velocity(Frozen):
    """Velocity of the vehicle against the world."""

    columns: tuple[str, str, str]
    unit: Literal["m/s", "cm/s", "mm/s"] = "m/s"
    axes: Literal["world", "body"] = "world"
    """Along whose axes its columns are."""


class Thrust(Frozen):
    """The collective thrust that was commanded."""

    column: str
    newton_per_unit: Factor | Literal["fit"] = 1.0
    """`fit` chooses the factor with which thrust explains the motion best, as for normalised
    commands; the sign is then found as well."""


class ColumnMap(Frozen):
    """Meaning of a log's columns, and constants of its vehicle."""

    time: TimeColumn | None = None
    attitude: Attitude
    velocity: Velocity
    thrust: Thrust
    frame: Literal["NED", "ENU"]
    check_frame: bool = True
    """NED with a body whose z axis points down, or ENU with one whose z axis points up; with
    `check_frame` only where the motion does not contradict it."""
    mass_kg: Mass | None = None
    drag_kgps: tuple[Drag, Drag, Drag] | None = None
    """Linear drag along the body's axes; `None`: what thrust and weight leave is one force."""

    @property
    def names(self) -> tuple[str, ...]:
        """The columns that are read, time apart."""
        return (*self.attitude.columns, *self.velocity.columns, self.thrust.column)


def read_columns(where: str) -> ColumnMap:
    """Return the map in a YAML file, or the one that ships as `px4`.

    Raises `UserError` for a file that cannot be read or says something else.
    """
    try:
        shipped = resources.files("faultpath_quadrotor.flightlog") / "px4.yaml"
        data = shipped.read_bytes() if where == PX4 else contents(where)
        return read_yaml(data).fill(ColumnMap)
    except OSError as error:
        raise UserError(
            f"{where}: cannot be read ({error.strerror}): give the YAML file that says which "
            "columns hold what, or px4"
        ) from None
    except Misread as error:
        raise UserError(f"{error.at(where)}; see the example in docs/recorded-flights.md") from None


@dataclass(frozen=True)
class LogColumn:
    """One column: times in s, ascending, and values, all finite."""

    time_s: Floats
    values: Floats


def read_series(path: Path, columns: ColumnMap) -> Mapping[str, LogColumn]:
    """Return the columns that the map names.

    Raises `UserError` for a file that cannot be read, a column that it does not have or that holds
    no numbers, and times that do not ascend or cannot be of that unit.
    """
    readers = {".csv": _table, ".parquet": _table, ".ulg": _ulog, **dict.fromkeys(SUFFIXES, _bag)}
    reader = readers.get(path.suffix.lower(), _bag if path.is_dir() else None)
    if reader is None:
        raise UserError(
            f"{path}: is not a .csv, .parquet, .ulg, .mcap, .db3 or .bag file, nor the folder of a "
            "bag: convert it to one"
        )
    series: dict[str, LogColumn] = {}
    for name, (time_s, values) in reader(path, columns).items():
        for what, numbers, most in (("times", time_s, _LONGEST_S), ("values", values, _LARGEST)):
            if (odd := np.flatnonzero(np.abs(numbers) > most)).size:  # infinite ones too
                raise UserError(
                    f"{path}: the {what} of column '{name}' reach {numbers[odd[0]]:g} at its "
                    f"reading {odd[0]}, which no flight does: correct the log, or leave the cell "
                    "empty"
                )
        there = np.isfinite(time_s) & np.isfinite(values)  # what is empty is not a number
        times, values = time_s[there], values[there]
        if len(times) < 2:
            raise UserError(f"{path}: column '{name}' has fewer than two numbers: name another")
        if (back := np.flatnonzero(np.diff(times) < 0)).size:
            raise UserError(
                f"{path}: the times of column '{name}' go back at its reading {back[0] + 1}: sort "
                "the rows, name the column of time, or for a bag leave time out of the map"
            )
        times, first = np.unique(times, return_index=True)
        rate_hz = (len(times) - 1) / max(float(times[-1] - times[0]), 1e-9)
        if not 2 <= rate_hz <= 20_000:
            raise UserError(
                f"{path}: column '{name}' has {rate_hz:.3g} readings a second, which no flight log "
                "has: correct the unit of time"
            )
        series[name] = LogColumn(times, values[first])
    return series


def _table(path: Path, columns: ColumnMap) -> dict[str, tuple[Floats, Floats]]:
    try:
        data = contents(path)
        parquet = path.suffix.lower() == ".parquet"
        table: pa.Table = read_table(data) if parquet else csv.read_csv(BytesIO(data))
    except (OSError, pa.ArrowException, Unreadable) as error:
        raise UserError(f"{path}: cannot be read ({why(error)}): give a whole log") from None
    lines = () if parquet else enumerate(data.splitlines(), 1)
    if odd := next((number for number, line in lines if line.count(b'"') % 2), None):
        raise UserError(
            f"{path}, line {odd}: a quote opens a cell that does not end on the line, and would "
            "swallow the rows below: correct the line"
        )
    if columns.time is None:
        raise UserError(f"{path}: the map names no time column: add time: {{column: …, unit: s}}")
    numbers: dict[str, Floats] = {}
    for name in (columns.time.column, *columns.names):
        whole, _, place = name.removesuffix("]").rpartition("[")
        listed = (
            name not in table.column_names and place.isdecimal() and whole in table.column_names
        )
        of = whole if listed else name
        if of not in table.column_names:
            raise UserError(f"{path}: {unknown('column', of, table.column_names)}")
        if table.column_names.count(of) > 1:
            raise UserError(f"{path}: two columns are called '{of}': give each a name of its own")
        try:
            numbers[name] = _listed(table[of], int(place)) if listed else _plain(table[of])
        except (pa.ArrowException, ValueError) as error:
            raise UserError(
                f"{path}: column '{of}' holds {error}: name another, or correct it"
            ) from None
    time_s = numbers[columns.time.column] * TIME_UNITS[columns.time.unit]
    return {name: (time_s, numbers[name]) for name in columns.names}


def _plain(column: Any) -> Floats:
    try:
        if pa.types.is_boolean(column.type):
            raise pa.ArrowInvalid
        return column.cast(pa.float64()).to_numpy()
    except pa.ArrowException:
        raise ValueError(f"{column.type} and no numbers (of a list give one, as v[0])") from None


def _listed(column: Any, place: int) -> Floats:
    """Return a number of each cell, such as `[1.0, 2.0]` or, row after row, `[[1, 0], [0, 1]]`.

    `ValueError` says what is there instead.
    """
    cells = [str(cell or "").translate(_NO_BRACKETS).split() for cell in column.to_pylist()]
    length = max(map(len, cells), default=0)
    if lengths := {len(cell) for cell in cells} - {0, length}:
        raise ValueError(f"lists of {length} and of {min(lengths)} numbers")
    if place >= length:
        raise ValueError(f"lists of {length} numbers, of which none is [{place}], counted from 0")
    try:
        return np.array([cell[place] if cell else "nan" for cell in cells], np.float64)
    except ValueError as error:
        raise ValueError(f"no lists of numbers ({error})") from None


def _bag(path: Path, columns: ColumnMap) -> dict[str, tuple[Floats, Floats]]:
    time = columns.time
    return read_bag(path, columns.names, time and (time.column, TIME_UNITS[time.unit]))


def _ulog(path: Path, columns: ColumnMap) -> dict[str, tuple[Floats, Floats]]:
    try:
        # It ships no types.
        from pyulog import ULog  # pyright: ignore[reportMissingTypeStubs]
    except ImportError:
        raise UserError(
            "reading .ulg files needs pyulog, not installed here: in the checkout of faultpath, "
            "pip install './quadrotor[ulog]'"
        ) from None
    topics = sorted({name.partition(".")[0] for name in columns.names})
    try:
        log = cast(Any, ULog(BytesIO(contents(path)), topics))
    except Exception as error:  # pyulog raises whatever a damaged file leads it into
        raise UserError(
            f"{path}: cannot be read as a ULog file ({why(error)}): give a whole log"
        ) from None
    # Of several messages with one name the first counts.
    messages = {message.name: message.data for message in reversed(log.data_list)}
    series: dict[str, tuple[Floats, Floats]] = {}
    for name in columns.names:
        topic, _, field = name.partition(".")
        if topic not in messages:
            raise UserError(f"{path}: {unknown('message', topic, sorted(messages))}")
        if field not in messages[topic]:
            raise UserError(f"{path}: {unknown('field', name, sorted(messages[topic]))}")
        if "timestamp" not in messages[topic]:
            raise UserError(f"{path}: message '{topic}' has no timestamp: record it with its times")
        time_s = np.asarray(messages[topic]["timestamp"], dtype=np.float64) * TIME_UNITS["us"]
        series[name] = time_s, np.asarray(messages[topic][field], dtype=np.float64)
    return series
