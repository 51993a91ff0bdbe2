"""Logs as they lie in files: which columns hold what, in which units, and their readings."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from io import BytesIO
from pathlib import Path
from typing import Any, Literal, cast

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as csv
from pydantic import PositiveFloat

from faultpath.plugin.data import Unreadable, read_table
from faultpath.plugin.system import Frozen, Misread, UserError, contents, read_yaml, unknown
from faultpath_quadrotor.flightlog.bags import SUFFIXES, Floats, read_bag, why

_LARGEST = 1e12
"""No time in s and no value is larger; seconds since 1970 are a thousandth of it."""
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
    newton_per_unit: float | Literal["fit"] = 1.0
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
    mass_kg: PositiveFloat | None = None
    drag_kgps: tuple[PositiveFloat, PositiveFloat, PositiveFloat] | None = None
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
    for name, (times, values) in reader(path, columns).items():
        there = ~np.isnan(times) & ~np.isnan(values)  # what is empty is not a number
        column = LogColumn(times[there], values[there])
        if wrong := _wrong(column):
            raise UserError(f"{path}: column '{name}' {wrong}")
        time_s, first = np.unique(column.time_s, return_index=True)
        series[name] = LogColumn(time_s, column.values[first])
    return series


def _wrong(column: LogColumn) -> str:
    """Return in words what no log of a flight has; empty where there is nothing of that."""
    times, values = column.time_s, column.values
    if len(times) < 2:
        return "has fewer than two numbers: name another"
    for numbers in (times, values):
        if (odd := np.flatnonzero(np.abs(numbers) > _LARGEST)).size:  # infinite ones too
            return (
                f"reaches {numbers[odd[0]]:g} at its reading {odd[0]}, which no flight does: "
                "correct the log, or leave the cell empty"
            )
    if (back := np.flatnonzero(np.diff(times) < 0)).size:
        return (
            f"has times that go back at its reading {back[0] + 1}: sort the rows, name the column "
            "of time, or for a bag leave time out of the map"
        )
    rate_hz = (len(times) - 1) / max(float(times[-1] - times[0]), 1e-9)
    if not 2 <= rate_hz <= 20_000:
        return (
            f"has {rate_hz:.3g} readings a second, which no flight log has: correct the unit of "
            "time"
        )
    return ""


def _table(path: Path, columns: ColumnMap) -> dict[str, tuple[Floats, Floats]]:
    if columns.time is None:
        raise UserError(f"{path}: the map names no time column: add time: {{column: …, unit: s}}")
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
    time_s = _numbers(path, table, columns.time.column) * TIME_UNITS[columns.time.unit]
    return {name: (time_s, _numbers(path, table, name)) for name in columns.names}


def _numbers(path: Path, table: pa.Table, name: str) -> Floats:
    """Return a column, or with a name such as `v[2]` the third number of each of its lists."""
    whole, _, place = name.removesuffix("]").rpartition("[")
    listed = name not in table.column_names and place.isdecimal() and whole in table.column_names
    of = whole if listed else name
    if of not in table.column_names:
        raise UserError(f"{path}: {unknown('column', of, table.column_names)}")
    if table.column_names.count(of) > 1:
        raise UserError(f"{path}: two columns are called '{of}': give each a name of its own")
    kind = table[of].type
    try:
        if pa.types.is_boolean(kind):
            raise pa.ArrowInvalid
        column = pc.list_element(table[of], int(place)) if listed else table[of]
        return column.cast(pa.float64()).to_numpy()
    except pa.ArrowException:
        raise UserError(
            f"{path}: column '{of}' holds {kind} and no numbers for {name}: name another, or "
            "correct it"
        ) from None


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
    series: dict[str, tuple[Floats, Floats]] = {}
    for message in reversed(log.data_list):  # of several messages with one name the first counts
        if "timestamp" in message.data:
            time_s = np.asarray(message.data["timestamp"], np.float64) * TIME_UNITS["us"]
            for field, values in message.data.items():
                series[f"{message.name}.{field}"] = time_s, np.asarray(values, np.float64)
    for name in columns.names:
        if name not in series:
            raise UserError(f"{path}: {unknown('field', name, sorted(series))}")
    return {name: series[name] for name in columns.names}
