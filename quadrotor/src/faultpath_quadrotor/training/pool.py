"""A pool of training episodes on disk: rows, episodes, and where they come from.

Three files: `<pool>.parquet` has one row a control instant, `<pool>.episodes.parquet` one row an
episode with its vehicle, `<pool>.json` says how both were made and carries their hashes. The last
is written last: a pool without it is not finished.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from faultpath.plugin.data import read_table, write
from faultpath.plugin.system import UserError, contents
from faultpath_quadrotor.training.provenance import read_provenance
from faultpath_quadrotor.training.recorded import COMPONENTS, SIGNALS, Flights
from faultpath_quadrotor.vehicle import VehicleParameters

_AXES = ("x", "y", "z")


@dataclass(frozen=True)
class FlightData:
    """Recorded episodes in memory, wherever they were flown."""

    name: str
    values: np.ndarray
    """float32 [C, R] in the order of `flight.COMPONENTS`; episodes one after the other."""
    steps: np.ndarray
    """Control steps of each episode, [E]; it has one row more than steps."""
    vehicles: dict[str, np.ndarray]
    """Fields of `Vehicle` by name, float64, [E] or [3, E]."""

    @property
    def first_row(self) -> np.ndarray:
        """Return the row of each episode's first instant, [E]."""
        return np.concatenate(([0], np.cumsum(self.steps + 1)[:-1]))

    @classmethod
    def decode(cls, name: str, rows: bytes, episodes: bytes) -> FlightData:
        """Read what `encode_rows` and `encode_episodes` wrote."""
        table, flights = read_table(rows), read_table(episodes)
        return cls(
            name=name,
            values=np.stack([table.column(name).to_numpy() for name in COMPONENTS]),
            steps=flights.column("steps").to_numpy().astype(np.int64),
            vehicles={name: _vehicle(flights, name) for name in VehicleParameters.model_fields},
        )


def episodes_path(path: Path) -> Path:
    """Return where the episodes of the pool whose rows are in `path` stand."""
    return path.with_suffix(".episodes.parquet")


def encode_rows(episodes: Sequence[int], flights: Flights) -> bytes:
    """Return the rows of a batch as a Parquet file."""
    instants = np.arange(flights.values.shape[1])
    kept = (instants <= flights.steps[:, None]).reshape(-1)
    lanes = len(flights.steps)
    columns = {
        "episode": np.repeat(np.asarray(episodes, np.int32), len(instants))[kept],
        "step": np.tile(instants.astype(np.int16), lanes)[kept],
    }
    for name, values in zip(COMPONENTS, flights.values, strict=True):
        columns[name] = values.T.reshape(-1)[kept]
    for name in SIGNALS["command"]:  # no command acts after an episode's last state
        columns[name][np.cumsum(flights.steps + 1) - 1] = np.nan
    return _write([pa.table(columns)])


def encode_episodes(episodes: Sequence[int], flights: Flights) -> bytes:
    """Return the lengths and vehicles of a batch as a Parquet file."""
    columns = {"episode": np.asarray(episodes, np.int32), "steps": flights.steps.astype(np.int16)}
    for name in VehicleParameters.model_fields:
        values = np.array([getattr(vehicle, name) for vehicle in flights.vehicles])
        axes = _columns(name, values.ndim == 2)
        columns.update(zip(axes, np.atleast_2d(values.T), strict=True))
    return _write([pa.table(columns)])


def write_flights(stem: Path, episodes: Sequence[int], flights: Flights) -> None:
    """Write a batch as `<stem>.episodes` and `<stem>.rows`; the rows are written last."""
    write(Path(f"{stem}.episodes"), encode_episodes(episodes, flights))
    write(Path(f"{stem}.rows"), encode_rows(episodes, flights))


def join_flights(stems: Sequence[Path]) -> tuple[bytes, bytes]:
    """Return the rows and the episodes of batches that `write_flights` wrote.

    Each batch is a row group of the two Parquet files.
    """
    return (
        _write(read_table(contents(f"{stem}.rows")) for stem in stems),
        _write(read_table(contents(f"{stem}.episodes")) for stem in stems),
    )


def read_pool(path: Path) -> FlightData:
    """Read a pool; `UserError` when it is missing, unfinished or damaged."""
    provenance = read_provenance(path)
    if provenance is None:
        raise UserError(f"there is no finished pool at {path}: collect it first.")
    rows = _read(path, provenance.rows_sha256)
    episodes = _read(episodes_path(path), provenance.episodes_sha256)
    return FlightData.decode(provenance.pool, rows, episodes)


def _read(path: Path, sha256: str) -> bytes:
    try:
        data = contents(path)
    except OSError as error:
        raise UserError(
            f"cannot read {path} ({error.strerror}): delete the pool and collect it again."
        ) from error
    if hashlib.sha256(data).hexdigest() != sha256:
        raise UserError(
            f"{path} is not the file that its pool was finished with: delete the pool and collect "
            "it again."
        )
    return data


def _vehicle(episodes: pa.Table, name: str) -> np.ndarray:
    columns = _columns(name, f"{name}_x" in episodes.column_names)
    values = np.stack([episodes.column(column).to_numpy() for column in columns])
    return values if len(columns) > 1 else values[0]


def _columns(name: str, by_axis: bool) -> list[str]:
    return [f"{name}_{axis}" for axis in _AXES] if by_axis else [name]


def _write(tables: Iterable[pa.Table]) -> bytes:
    """Return tables as row groups of a file; floats split by byte compress better under zstd."""
    sink, others = pa.BufferOutputStream(), iter(tables)
    first = next(others)
    floats = [field.name for field in first.schema if pa.types.is_floating(field.type)]
    split = dict.fromkeys(floats, "BYTE_STREAM_SPLIT")
    options = {"compression": "zstd", "use_dictionary": False, "column_encoding": split}
    with pq.ParquetWriter(sink, first.schema, **options) as writer:
        for table in chain((first,), others):
            writer.write_table(table)
    return sink.getvalue().to_pybytes()
