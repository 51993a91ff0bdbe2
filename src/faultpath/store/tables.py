"""Outcomes and traces as Parquet: one schema for the shards, one for the assembled tables."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError

from faultpath.errors import UserError
from faultpath.store.parquet import Column, Kind, Unreadable, Values, decode, decode_noted, encode
from faultpath.taps import TapCount
from faultpath.trials.outcome import Outcome, Status
from faultpath.trials.table import OutcomeTable, TrialRow

Trace = NDArray[np.float32]
_Read = TypeVar("_Read")

_ADDRESS = (
    Column("variant", Kind.TEXT),
    Column("path", Kind.TEXT),
    Column("seed", Kind.INTEGER),
    Column("scene", Kind.TEXT),
)
_PLACE = (Column("scene_index", Kind.INTEGER), Column("topology", Kind.TEXT))
_RESULT = (
    Column("status", Kind.TEXT),
    Column("time_s", Kind.NUMBER),
    Column("terminal_distance_m", Kind.NUMBER),
    Column("min_clearance_m", Kind.NUMBER),
    Column("struck_steps", Kind.INTEGER),
    Column("altered_steps", Kind.INTEGER),
    Column("initial_hash", Kind.TEXT),
    Column("disturbance_hash", Kind.TEXT),
    Column("planner_noise_hash", Kind.TEXT),
    Column("error", Kind.TEXT),
)
_MAY_LACK = ("time_s", "terminal_distance_m", "min_clearance_m", "error")
_ALWAYS = tuple(column for column in _RESULT if column.name not in _MAY_LACK)
_TRACE = tuple(Column(name, Kind.NUMBERS) for name in ("x_m", "y_m", "z_m"))
_SHARD = (Column("scene", Kind.TEXT), *_RESULT, *_TRACE)
_OUTCOMES = (*_ADDRESS, *_PLACE, *_RESULT)
_TRACES = (*_ADDRESS, *_TRACE)
_KEY = "faultpath.key"
"""Under which name a shard's metadata keeps the key of its unit."""
_TAPS = "faultpath.taps"
"""Under which name a shard's metadata keeps what the taps did."""
_COUNTS = TypeAdapter(tuple[TapCount, ...])


class TrialAddress(NamedTuple):
    """Where a trial stands in a study."""

    variant: str
    path: str
    seed: int
    scene: str


@dataclass(frozen=True)
class Shard:
    """One finished block."""

    outcomes: tuple[Outcome, ...]
    taps: tuple[TapCount, ...]
    """What the taps did in the trials that did not fail."""


def encode_shard(key: str, shard: Shard) -> bytes:
    """Return one block, traces included, with the key of its unit inside."""
    notes = {_KEY: key, _TAPS: _COUNTS.dump_json(shard.taps).decode()}
    return encode(_SHARD, {**_results(shard.outcomes), **_traces(shard.outcomes)}, notes)


def decode_shard(data: bytes, key: str) -> Shard:
    """Return one block; `Unreadable` when the bytes are not the shard of `key`, whole."""
    values, notes = decode_noted(data, _SHARD)
    if _TAPS not in notes:
        raise Unreadable("it is of an earlier version, which kept no receipts of the taps")
    if notes.get(_KEY) != key:
        raise Unreadable("it was written under another key")
    try:
        taps = _COUNTS.validate_json(notes[_TAPS])
    except ValidationError as error:
        raise Unreadable("its receipts of the taps cannot be read") from error
    outcomes = (
        _outcome(row, _trace([row[column.name] for column in _TRACE])) for row in _rows(values)
    )
    return Shard(tuple(outcomes), taps)


def encode_outcomes(table: OutcomeTable) -> bytes:
    """Return the table without its traces."""
    outcomes = [row.outcome for row in table.rows]
    place = {column.name: [getattr(r, column.name) for r in table.rows] for column in _PLACE}
    return encode(_OUTCOMES, {**_address(table), **place, **_results(outcomes)})


def encode_traces(table: OutcomeTable) -> bytes:
    """Return the traces of the trials that have one."""
    traced = OutcomeTable(tuple(row for row in table.rows if row.outcome.trace is not None))
    outcomes = [row.outcome for row in traced.rows]
    return encode(_TRACES, {**_address(traced), **_traces(outcomes)})


def read_outcomes(path: Path) -> OutcomeTable:
    """Read an assembled outcome table (without traces); `UserError` when there is none to read."""
    return _read(path, decode_outcomes)


def read_traces(path: Path) -> dict[TrialAddress, Trace]:
    """Read assembled traces, `[T, 3]` each, metres; `UserError` when there are none to read."""
    return _read(path, decode_traces)


def decode_outcomes(data: bytes) -> OutcomeTable:
    """Return an assembled outcome table (without traces); `Unreadable` when it is not one."""
    return OutcomeTable(
        tuple(
            TrialRow(
                variant=row["variant"],
                path=row["path"],
                seed=row["seed"],
                scene_index=row["scene_index"],
                topology=row["topology"],
                outcome=_outcome(row, None),
            )
            for row in _rows(_filled(decode(data, _OUTCOMES), (*_ADDRESS, *_PLACE, *_ALWAYS)))
        )
    )


def decode_traces(data: bytes) -> dict[TrialAddress, Trace]:
    """Return assembled traces, `[T, 3]` each, metres; `Unreadable` when they are not that."""
    traces: dict[TrialAddress, Trace] = {}
    for row in _rows(_filled(decode(data, _TRACES), _ADDRESS)):
        trace = _trace([row[column.name] for column in _TRACE])
        if trace is not None:
            address = TrialAddress(row["variant"], row["path"], row["seed"], row["scene"])
            traces[address] = trace
    return traces


def traces_of(table: OutcomeTable) -> dict[TrialAddress, Trace]:
    """Return the traces of a table by trial."""
    return {
        TrialAddress(row.variant, row.path, row.seed, row.outcome.scene): row.outcome.trace
        for row in table.rows
        if row.outcome.trace is not None
    }


def _read(path: Path, decoded: Callable[[bytes], _Read]) -> _Read:
    try:
        return decoded(path.read_bytes())
    except OSError as error:
        raise UserError(
            f"cannot read {path} ({error.strerror}): finish the run that writes it"
        ) from error
    except Unreadable as error:
        raise UserError(f"{path} is damaged ({error}): run the study again to rebuild it") from None


def _filled(values: dict[str, list[Any]], required: Sequence[Column]) -> dict[str, list[Any]]:
    for column in required:
        if any(value is None for value in values[column.name]):
            raise Unreadable(f"column {column.name!r} has gaps")
    return values


def _rows(values: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    return [dict(zip(values, row, strict=True)) for row in zip(*values.values(), strict=True)]


def _address(table: OutcomeTable) -> dict[str, Values]:
    return {
        "variant": [row.variant for row in table.rows],
        "path": [row.path for row in table.rows],
        "seed": [row.seed for row in table.rows],
        "scene": [row.outcome.scene for row in table.rows],
    }


def _results(outcomes: Sequence[Outcome]) -> dict[str, Values]:
    values: dict[str, Values] = {
        column.name: [getattr(outcome, column.name) for outcome in outcomes] for column in _RESULT
    }
    return {
        **values,
        "scene": [outcome.scene for outcome in outcomes],
        "status": [outcome.status.value for outcome in outcomes],
    }


def _traces(outcomes: Sequence[Outcome]) -> dict[str, Values]:
    traces = [None if o.trace is None else np.asarray(o.trace, np.float32) for o in outcomes]
    return {
        column.name: [None if trace is None else trace[:, axis] for trace in traces]
        for axis, column in enumerate(_TRACE)
    }


def _trace(axes: Sequence[Trace | None]) -> Trace | None:
    present = [axis for axis in axes if axis is not None]
    if len({len(axis) for axis in present}) > 1:
        raise Unreadable("the axes of a trace differ in length")
    return np.stack(present, axis=1) if len(present) == len(axes) else None


def _outcome(row: Mapping[str, Any], trace: Trace | None) -> Outcome:
    fields = {column.name: row[column.name] for column in _RESULT}
    try:
        status = Status(fields.pop("status"))
    except ValueError as error:
        raise Unreadable(str(error)) from error
    return Outcome(scene=row["scene"], status=status, trace=trace, **fields)
