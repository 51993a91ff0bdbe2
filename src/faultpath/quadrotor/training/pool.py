"""A pool of training episodes on disk: rows, episodes, and where they come from.

Three files: `<pool>.parquet` has one row a control instant, `<pool>.episodes.parquet` one row an
episode with its vehicle, `<pool>.json` says how both were made and carries their hashes. The last
is written last: a pool without it is not finished.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from pydantic import BaseModel, ConfigDict, ValidationError

from faultpath.errors import UserError
from faultpath.quadrotor.training.flight import COMPONENTS, Flights, FlightSettings
from faultpath.quadrotor.vehicle import CONTROL_DT_S, VehicleParameters, VehicleRanges
from faultpath.store import atomic, read_table

FORMAT = 1
_AXES = ("x", "y", "z")
_DECISIVE = ("quadrotor/training/controller.py", "quadrotor/training/perturbation.py")
_DECISIVE += ("quadrotor/training/flight.py", "quadrotor/plant", "quadrotor/wind.py")
_DECISIVE += ("quadrotor/vehicle.py", "quadrotor/state.py", "quadrotor/so3.py", "streams.py")


class Recipe(BaseModel):
    """What decides every number of a pool."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: int = FORMAT
    pool: str
    episodes: int
    seed: int
    flight: FlightSettings = FlightSettings()
    vehicle: VehicleRanges = VehicleRanges()
    wind: dict[str, float | tuple[float, float]]
    """Ranges and constants of the wind; empty in still air."""
    code_sha256: str
    """Of the files that draw and fly the episodes."""


class Provenance(Recipe):
    """A recipe, what it was cooked with, and what came of it."""

    faultpath_version: str
    packages: dict[str, str]
    rows: int
    vehicle_seconds: float
    ended_early: int
    """Episodes that diverged before their time was over."""
    rows_sha256: str
    episodes_sha256: str

    def encode(self) -> bytes:
        """Return the file's contents."""
        content = self.model_dump(mode="json")
        return (json.dumps(content, indent=2, sort_keys=True) + "\n").encode()


@dataclass(frozen=True)
class Pool:
    """A pool in memory."""

    name: str
    values: np.ndarray
    """float32 [C, R] in the order of `flight.COMPONENTS`; episodes one after the other."""
    steps: np.ndarray
    """Control steps of each episode, [E]; it has one row more than steps."""
    vehicles: dict[str, np.ndarray]
    """Fields of `Vehicle` by name, float64, [E] or [3, E]."""
    provenance: Provenance

    @property
    def first_row(self) -> np.ndarray:
        """Return the row of each episode's first instant, [E]."""
        return np.concatenate(([0], np.cumsum(self.steps + 1)[:-1]))


def episodes_path(path: Path) -> Path:
    """Return where the episodes of the pool whose rows are in `path` stand."""
    return path.with_suffix(".episodes.parquet")


def provenance_path(path: Path) -> Path:
    """Return where the provenance of the pool whose rows are in `path` stands."""
    return path.with_suffix(".json")


@cache
def code_sha256() -> str:
    """Return a hash of the files that draw and fly episodes: another code, another pool."""
    package = files("faultpath")
    parts = [package.joinpath(name) for name in _DECISIVE]
    digest = hashlib.sha256()
    while parts:
        part = parts.pop()
        if part.is_dir():
            parts += sorted(part.iterdir(), key=lambda child: child.name)
        elif part.name.endswith(".py"):
            digest.update(part.name.encode() + part.read_bytes())
    return digest.hexdigest()


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
    for name in COMPONENTS:  # no command acts after an episode's last state
        if "command" in name or name == "thrust_n":
            columns[name][np.cumsum(flights.steps + 1) - 1] = np.nan
    return _write([pa.table(columns)])


def encode_episodes(episodes: Sequence[int], flights: Flights) -> bytes:
    """Return the lengths and vehicles of a batch as a Parquet file."""
    columns = {
        "episode": np.asarray(episodes, np.int32),
        "steps": flights.steps.astype(np.int16),
    }
    for name in VehicleParameters.model_fields:
        values = np.array([getattr(vehicle, name) for vehicle in flights.vehicles])
        axes = _columns(name, values.ndim == 2)
        columns.update(zip(axes, np.atleast_2d(values.T), strict=True))
    return _write([pa.table(columns)])


def join(parts: Iterable[bytes]) -> bytes:
    """Return one Parquet file with each part's rows as a row group, in their order."""
    return _write(read_table(part) for part in parts)


def write_pool(path: Path, rows: bytes, episodes: bytes, provenance: Provenance) -> None:
    """Write a finished pool, its provenance last; `OSError` when the disk will not."""
    atomic.write(episodes_path(path), episodes)
    atomic.write(path, rows)
    atomic.write(provenance_path(path), provenance.encode())


def read_provenance(path: Path) -> Provenance | None:
    """Return the provenance of the pool at `path`, `None` without one; `UserError` if damaged."""
    place = provenance_path(path)
    try:
        return Provenance.model_validate_json(place.read_bytes())
    except FileNotFoundError:
        return None
    except (OSError, ValidationError) as error:
        raise UserError(
            f"{place} cannot be read as a pool's provenance: delete the pool and collect it again."
        ) from error


def read_pool(path: Path) -> Pool:
    """Read a pool; `UserError` when it is missing, unfinished or damaged."""
    provenance = read_provenance(path)
    if provenance is None:
        raise UserError(f"there is no finished pool at {path}: collect it first.")
    table = _read(path, provenance.rows_sha256)
    episodes = _read(episodes_path(path), provenance.episodes_sha256)
    return Pool(
        name=provenance.pool,
        values=np.stack([table.column(name).to_numpy() for name in COMPONENTS]),
        steps=episodes.column("steps").to_numpy().astype(np.int64),
        vehicles={name: _vehicle(episodes, name) for name in VehicleParameters.model_fields},
        provenance=provenance,
    )


def steps_of(episodes: bytes) -> np.ndarray:
    """Return the control steps of each episode in an encoded episode table, [E]."""
    return read_table(episodes).column("steps").to_numpy().astype(np.int64)


def vehicle_seconds(steps: np.ndarray) -> float:
    """Return the time flown in episodes of these lengths."""
    return round(float(steps.sum()) * CONTROL_DT_S, 3)


def _read(path: Path, sha256: str) -> pa.Table:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UserError(
            f"cannot read {path} ({error.strerror}): delete the pool and collect it again."
        ) from error
    if hashlib.sha256(data).hexdigest() != sha256:
        raise UserError(
            f"{path} is not the file that its pool was finished with: delete the pool and collect "
            "it again."
        )
    return read_table(data)


def _vehicle(episodes: pa.Table, name: str) -> np.ndarray:
    columns = _columns(name, f"{name}_x" in episodes.column_names)
    values = np.stack([episodes.column(column).to_numpy() for column in columns])
    return values if len(columns) > 1 else values[0]


def _columns(name: str, by_axis: bool) -> list[str]:
    return [f"{name}_{axis}" for axis in _AXES] if by_axis else [name]


def _write(tables: Iterable[pa.Table]) -> bytes:
    """Row groups as they come; splitting floats by byte lets zstd find what they share."""
    sink = pa.BufferOutputStream()
    writer = None
    for table in tables:
        if writer is None:
            floats = [f.name for f in table.schema if pa.types.is_floating(f.type)]
            writer = pq.ParquetWriter(
                sink,
                table.schema,
                compression="zstd",
                use_dictionary=False,
                column_encoding=dict.fromkeys(floats, "BYTE_STREAM_SPLIT"),
            )
        writer.write_table(table)
    if writer is not None:
        writer.close()
    return sink.getvalue().to_pybytes()
