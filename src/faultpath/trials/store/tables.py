"""Outcomes and traces as Parquet: one schema for the shards, one for the assembled tables."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError

from faultpath.core.errors import UserError
from faultpath.core.files.opening import contents
from faultpath.loop import TapCount
from faultpath.trials.metrics import VEHICLE
from faultpath.trials.outcome import Outcome, Status, checked
from faultpath.trials.store.parquet import (
    INTEGER,
    NUMBER,
    NUMBERS,
    TEXT,
    Row,
    Schema,
    Unreadable,
    decode,
    encode,
    numbers_in,
)
from faultpath.trials.table import OutcomeTable, TrialRow

Trace = NDArray[np.float32]
_Read = TypeVar("_Read")

_ADDRESS = {"variant": TEXT, "path": TEXT, "seed": INTEGER, "scene": TEXT}
_PLACE = {"scene_index": INTEGER, "topology": TEXT}
_END = {"status": TEXT, "time_s": NUMBER}
_RESULT = {
    "struck_steps": INTEGER,
    "altered_steps": INTEGER,
    "initial_hash": TEXT,
    "disturbance_hash": TEXT,
    "planner_noise_hash": TEXT,
    "error": TEXT,
}
_TRACE = dict.fromkeys(("x_m", "y_m", "z_m"), NUMBERS)
_MAY_LACK = ("time_s", "error", *_TRACE)
_TRACES = {**_ADDRESS, **_TRACE}
_KEY = "faultpath.key"
"""Under which name a shard's metadata keeps the key of its unit."""
_TAPS = "faultpath.loop.taps"
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
    schema = _shard(_metrics(shard.outcomes))
    return encode(schema, ({**dict.fromkeys(schema), **_cells(o)} for o in shard.outcomes), notes)


def decode_shard(data: bytes, key: str) -> Shard:
    """Return one block; `Unreadable` when the bytes are not the shard of `key`, whole."""
    names = _metrics_in(data)
    rows, notes = decode(data, _shard(names), (*_MAY_LACK, *names))
    if _TAPS not in notes:
        raise Unreadable("it is of an earlier version, which kept no receipts of the taps")
    if notes.get(_KEY) != key:
        raise Unreadable("it was written under another key")
    try:
        taps = _COUNTS.validate_json(notes[_TAPS])
    except ValidationError as error:
        raise Unreadable("its receipts of the taps cannot be read") from error
    return Shard(tuple(_outcome(row, _trace(row), names) for row in rows), taps)


def encode_outcomes(table: OutcomeTable) -> bytes:
    """Return the table without its traces."""
    schema = _outcomes(_metrics(row.outcome for row in table.rows))
    return encode(schema, (_flat(row, schema) for row in table.rows))


def encode_traces(table: OutcomeTable) -> bytes:
    """Return the traces of the trials that have one."""
    traced = (row for row in table.rows if row.outcome.trace is not None)
    return encode(_TRACES, (_flat(row, _TRACES) for row in traced))


def read_outcomes(path: Path) -> OutcomeTable:
    """Read an assembled outcome table (without traces); `UserError` when there is none to read."""
    return _read(path, decode_outcomes)


def read_traces(path: Path) -> dict[TrialAddress, Trace]:
    """Read assembled traces, `[T, 3]` each, metres; `UserError` when there are none to read."""
    return _read(path, decode_traces)


def decode_outcomes(data: bytes) -> OutcomeTable:
    """Return an assembled outcome table (without traces); `Unreadable` when it is not one."""
    names = _metrics_in(data)
    rows, _ = decode(data, _outcomes(names), (*_MAY_LACK, *names))
    at = ("variant", "path", "seed", *_PLACE)
    placed = (({name: row[name] for name in at}, _outcome(row, None, names)) for row in rows)
    return OutcomeTable(tuple(TrialRow(**place, outcome=outcome) for place, outcome in placed))


def decode_traces(data: bytes) -> dict[TrialAddress, Trace]:
    """Return assembled traces, `[T, 3]` each, metres; `Unreadable` when they are not that."""
    rows, _ = decode(data, _TRACES, _MAY_LACK)
    return {
        TrialAddress(*(row[name] for name in _ADDRESS)): trace
        for row in rows
        if (trace := _trace(row)) is not None
    }


def traces_of(table: OutcomeTable) -> dict[TrialAddress, Trace]:
    """Return the traces of a table by trial."""
    return {
        TrialAddress(row.variant, row.path, row.seed, row.outcome.scene): row.outcome.trace
        for row in table.rows
        if row.outcome.trace is not None
    }


def _read(path: Path, decoded: Callable[[bytes], _Read]) -> _Read:
    try:
        return decoded(contents(path))
    except OSError as error:
        raise UserError(
            f"cannot read {path} ({error.strerror}): finish the run that writes it"
        ) from error
    except Unreadable as error:
        raise UserError(f"{path} is damaged ({error}): run the study again to rebuild it") from None


def _shard(metrics: Iterable[str]) -> Schema:
    return {"scene": TEXT, **_END, **dict.fromkeys(metrics, NUMBER), **_RESULT, **_TRACE}


def _outcomes(metrics: Iterable[str]) -> Schema:
    return {**_ADDRESS, **_PLACE, **_END, **dict.fromkeys(metrics, NUMBER), **_RESULT}


def _metrics(outcomes: Iterable[Outcome]) -> list[str]:
    found = dict.fromkeys(name for outcome in outcomes for name in outcome.metrics)
    vehicle = VEHICLE if any(name in VEHICLE for name in found) else ()
    return list(dict.fromkeys((*vehicle, *found)))


def _metrics_in(data: bytes) -> list[str]:
    return [name for name in numbers_in(data) if name not in _END]


def _flat(row: TrialRow, schema: Schema) -> Row:
    return {**dict.fromkeys(schema), **vars(row), **_cells(row.outcome)}


def _cells(outcome: Outcome) -> Row:
    axes = (None,) * 3 if outcome.trace is None else np.asarray(outcome.trace, np.float32).T
    return {**outcome.metrics, **vars(outcome), **dict(zip(_TRACE, axes, strict=True))}


def _trace(row: Row) -> Trace | None:
    present = [row[axis] for axis in _TRACE if row[axis] is not None]
    if len({len(axis) for axis in present}) > 1:
        raise Unreadable("the axes of a trace differ in length")
    if len(present) < len(_TRACE):
        return None
    trace = np.stack(present, axis=1)
    if not np.isfinite(trace).all():
        raise Unreadable(f"the trace of scene '{row['scene']}' is not finite")
    return trace


def _outcome(row: Mapping[str, Any], trace: Trace | None, metrics: Iterable[str]) -> Outcome:
    fields = {name: row[name] for name in (*_END, *_RESULT)}
    found = {name: row[name] for name in metrics if row[name] is not None}
    try:
        status = Status(fields.pop("status"))
    except ValueError as error:
        raise Unreadable(str(error)) from error
    outcome = Outcome(scene=row["scene"], status=status, trace=trace, metrics=found, **fields)
    _check(outcome)
    return outcome


def _check(outcome: Outcome) -> None:
    """Refuse what no trial leaves behind: whoever wrote it may have been anybody."""
    steps = (outcome.struck_steps, outcome.altered_steps)
    wrong = "a count of steps is below 0" if min(steps) < 0 else ""
    if not outcome.failed:
        found = checked(outcome, outcome.metrics)
        wrong = wrong or (found.error or "") * found.failed
    elif outcome.time_s is not None and not np.isfinite(outcome.time_s):  # pyright: ignore[reportUnnecessaryComparison]
        wrong = wrong or "time_s is not finite"
    if wrong:
        raise Unreadable(f"scene '{outcome.scene}': {wrong}")
