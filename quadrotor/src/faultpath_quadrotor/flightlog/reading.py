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
import pyarrow.parquet as pq
from numpy.typing import NDArray
from pydantic import Field

from faultpath.core.errors import UserError
from faultpath.core.files.opening import contents
from faultpath.core.files.plain import Misread, read_yaml
from faultpath.core.results import Frozen
from faultpath.core.text import one_line, unknown

Floats: TypeAlias = NDArray[np.float64]
_LONGEST_S = 1e12
"""A time of more seconds is no time; those since 1970 are a thousandth of it."""
_LARGEST = 1e9
"""A million metres a second, in the smallest unit."""
HEAVIEST_KG = 1e6
Mass: TypeAlias = Annotated[float, Field(ge=1e-6, le=HEAVIEST_KG)]
Drag: TypeAlias = Annotated[float, Field(ge=1e-9, le=1e6)]
Factor: TypeAlias = Annotated[float, Field(ge=-1e9, le=1e9)]
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
SPEED_UNITS = {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3}
PX4 = "px4"
"""The map that ships, for ULog files of PX4."""


class TimeColumn(Frozen):
    """When a row was recorded; ULog files bring a time with every message, and need none."""

    column: str
    unit: Literal["s", "ms", "us", "ns"]


class Attitude(Frozen):
    """A unit quaternion from the body to the world."""

    columns: tuple[str, str, str, str]
    order: Literal["wxyz", "xyzw"]


class Velocity(Frozen):
    """Velocity in the world frame."""

    columns: tuple[str, str, str]
    unit: Literal["m/s", "cm/s", "mm/s"] = "m/s"


class Thrust(Frozen):
    """The collective thrust that was commanded."""

    column: str
    newton_per_unit: Factor | Literal["fit"] = 1.0
    """`fit` chooses the factor with which thrust explains the motion best, as for normalised
    commands; the sign is then found as well."""


class ColumnMap(Frozen):
    """What a log's columns mean, and what is known of its vehicle."""

    time: TimeColumn | None = None
    attitude: Attitude
    velocity: Velocity
    thrust: Thrust
    frame: Literal["NED", "ENU"]
    """NED with a body whose z axis points down, or ENU with one whose z axis points up."""
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
        if where == PX4:
            data = (
                resources.files("faultpath_quadrotor.flightlog").joinpath("px4.yaml").read_bytes()
            )
        else:
            data = contents(where)
        return read_yaml(data).fill(ColumnMap)
    except OSError as error:
        raise UserError(
            f"{where}: cannot be read ({error.strerror}): give the YAML file that says which "
            "columns hold what, or px4"
        ) from None
    except Misread as error:
        raise UserError(f"{error.at(where)}; see the example in docs/recorded-flights.md") from None


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
    readers = {".csv": _table, ".parquet": _table, ".ulg": _ulog}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise UserError(f"{path}: is not a .csv, .parquet or .ulg file: convert it to one")
    series: dict[str, Series] = {}
    for name, (time_s, values) in reader(path, columns).items():
        for what, found, most in (("times", time_s, _LONGEST_S), ("values", values, _LARGEST)):
            if (odd := np.flatnonzero(np.abs(found) > most)).size:  # infinite ones too
                raise UserError(
                    f"{path}: the {what} of column '{name}' reach {found[odd[0]]:g} at its reading "
                    f"{odd[0]}, which no flight does: correct the log, or leave the cell empty"
                )
        there = np.isfinite(time_s) & np.isfinite(values)  # what is empty is not a number
        times, numbers = time_s[there], values[there]
        if len(times) < 2:
            raise UserError(f"{path}: column '{name}' has fewer than two numbers: name another")
        if (back := np.flatnonzero(np.diff(times) < 0)).size:
            raise UserError(
                f"{path}: the times of column '{name}' go back at its reading {back[0] + 1}: sort "
                "the rows, or name the column of time"
            )
        times, first = np.unique(times, return_index=True)
        rate_hz = (len(times) - 1) / max(float(times[-1] - times[0]), 1e-9)
        if not 2 <= rate_hz <= 20_000:
            raise UserError(
                f"{path}: column '{name}' has {rate_hz:.3g} readings a second, which no flight log "
                "has: correct the unit of time"
            )
        series[name] = Series(times, numbers[first])
    return series


def _table(path: Path, columns: ColumnMap) -> dict[str, tuple[Floats, Floats]]:
    try:
        data = BytesIO(contents(path))
        parquet = path.suffix.lower() == ".parquet"
        table: pa.Table = cast(Any, pq.ParquetFile(data)).read() if parquet else csv.read_csv(data)
    except (OSError, pa.ArrowException) as error:
        raise UserError(f"{path}: cannot be read ({_why(error)}): give a whole log") from None
    if columns.time is None:
        raise UserError(f"{path}: the map names no time column: add time: {{column: …, unit: s}}")
    found: dict[str, Floats] = {}
    for name in (columns.time.column, *columns.names):
        if name not in table.column_names:
            raise UserError(f"{path}: {unknown('column', name, table.column_names)}")
        if table.column_names.count(name) > 1:
            raise UserError(f"{path}: two columns are called '{name}': give each a name of its own")
        kind: Any = table[name].type
        try:
            if pa.types.is_boolean(kind):
                raise pa.ArrowInvalid
            found[name] = table[name].cast(pa.float64()).to_numpy()
        except pa.ArrowException:
            raise UserError(
                f"{path}: column '{name}' holds {kind} and no numbers: name another, or correct it"
            ) from None
    time_s = found[columns.time.column] * TIME_UNITS[columns.time.unit]
    return {name: (time_s, found[name]) for name in columns.names}


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
            f"{path}: cannot be read as a ULog file ({_why(error)}): give a whole log"
        ) from None
    messages = {each.name: each.data for each in reversed(log.data_list)}  # the first of a name
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
