"""Outcomes and traces as Parquet: one schema for the shards, one for the assembled tables."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError

from faultpath.core.errors import UserError
from faultpath.core.files.parquet import (
    INTEGER,
    NUMBER,
    NUMBERS,
    TEXT,
    Row,
    Schema,
    Unreadable,
    decode,
    encode,
    encode_columns,
    masked,
)
from faultpath.loop import TapCount
from faultpath.run.attempt import Done
from faultpath.run.trials import STATUSES, TEXTS, Trial, Trials
from faultpath.system.outcome import VEHICLE, Outcome, Status, checked

Trace = NDArray[np.float32]

_ADDRESS = {"variant": TEXT, "condition": TEXT, "seed": INTEGER, "scene": TEXT}
_PLACE = {"scene_index": INTEGER, "topology": TEXT}
_END = {"status": TEXT, "time_s": NUMBER}
_COUNTS = {"faulted_steps": INTEGER, "altered_steps": INTEGER}
_TRAJECTORY = {"trajectory_hash": TEXT}
_RESULT = {**_COUNTS, **dict.fromkeys(TEXTS, TEXT), "error": TEXT}
_TRACE = dict.fromkeys(("x_m", "y_m", "z_m"), NUMBERS)
_MAY_LACK = ("time_s", "error", *_TRACE)
_TRACES = {**_ADDRESS, **_TRACE}
FIXED = frozenset({*_ADDRESS, *_PLACE, *_END, *_RESULT, *_TRACE})
"""Columns that no metric can be called."""
_KEY, _TAPS = "faultpath.key", "faultpath.loop.taps"
"""Names under which a shard's metadata keeps the key of its unit, and what the taps did."""
_TAP_COUNTS = TypeAdapter(tuple[TapCount, ...])


class TrialAddress(NamedTuple):
    """Where a trial stands in a plan."""

    variant: str
    condition: str
    seed: int
    scene: str


def encode_shard(key: str, shard: Done) -> bytes:
    """Return one block, traces included, with the key of its unit inside."""
    notes = {_KEY: key, _TAPS: _TAP_COUNTS.dump_json(shard.taps).decode()}
    metrics = _columns(name for outcome in shard.outcomes for name in outcome.metrics)
    schema = {"scene": TEXT, **_END, **metrics, **_RESULT, **_TRACE}
    return encode(schema, map(_cells, shard.outcomes), notes)


def decode_shard(data: bytes, key: str) -> Done:
    """Return one block; `Unreadable` when the bytes are not the shard of `key`, whole."""
    schema = {"scene": TEXT, **_END, **_RESULT, **_TRACE}
    rows, notes = decode(data, schema, _MAY_LACK, more=NUMBER)
    if notes.get(_KEY) != key:
        raise Unreadable("it was written under another key")
    try:
        taps = _TAP_COUNTS.validate_json(notes[_TAPS])
    except (KeyError, ValidationError) as error:
        raise Unreadable("its delivery log cannot be read") from error
    return Done(tuple(_outcome(row, _trace(row)) for row in rows), taps)


def encode_outcomes(trials: Trials) -> bytes:
    """Return the trials without their traces, a row each."""
    variants, conditions, seeds, scenes = trials.places.T

    def named(labels: Iterable[object], places: NDArray[np.integer[Any]]) -> NDArray[Any]:
        return np.array(tuple(labels), object)[places]

    columns: dict[str, Any] = {
        "variant": named(trials.variants, variants),
        "condition": named(trials.conditions, conditions),
        "seed": named(trials.seeds, seeds),
        "scene": named((scene.id for scene in trials.scenes), scenes),
        "scene_index": named((scene.index for scene in trials.scenes), scenes),
        "topology": named((scene.topology for scene in trials.scenes), scenes),
        "status": named(STATUSES, trials.status),
        "time_s": masked(trials.time_s),
        "faulted_steps": trials.steps[0],
        "altered_steps": trials.steps[1],
        "error": [trials.errors.get(row) for row in range(len(trials))],
        **trials.texts,
    }
    empty = np.full(len(trials), np.nan)
    metrics = _columns(trials.metrics)
    columns |= {name: masked(trials.metrics.get(name, empty)) for name in metrics}
    return encode_columns({**_ADDRESS, **_PLACE, **_END, **metrics, **_RESULT}, columns)


def decode_outcomes(data: bytes, traces: Mapping[TrialAddress, Trace] | None = None) -> Trials:
    """Return the trials of an assembled table, with `traces` where there are any; `Unreadable` when
    it is not one.

    Where a trial that did not fail has no time, it is not a number: other tools write none.
    """
    schema = {**_ADDRESS, **_PLACE, **_END, **_RESULT}
    rows, _ = decode(data, schema, _MAY_LACK, more=NUMBER, absent=_TRAJECTORY)
    try:
        return Trials.of(_trial(row, traces or {}) for row in rows)
    except (ValueError, UserError) as error:
        raise Unreadable(str(error)) from error


def _trial(row: Row, traces: Mapping[TrialAddress, Trace]) -> Trial:
    address = _address(row)
    outcome = _outcome(row, traces.get(address), untimed=True)
    place = row["scene_index"], row["topology"]
    return Trial(address.variant, address.condition, address.seed, *place, outcome)


def encode_traces(trials: Trials) -> bytes:
    """Return the traces of the trials that have one."""
    traced = traces_of(trials).items()
    return encode(_TRACES, ({**at._asdict(), **_axes(trace)} for at, trace in traced))


def decode_traces(data: bytes) -> dict[TrialAddress, Trace]:
    """Return assembled traces, `[T, 3]` each, metres; `Unreadable` when they are not that."""
    rows, _ = decode(data, _TRACES, _MAY_LACK)
    return {_address(row): trace for row in rows if (trace := _trace(row)) is not None}


def traces_of(trials: Trials) -> dict[TrialAddress, Trace]:
    """Return the traces of trials by where these stand."""
    rows = sorted(trials.traces)
    places: list[list[int]] = trials.places[rows].tolist()
    return {
        TrialAddress(
            trials.variants[variant],
            trials.conditions[condition],
            trials.seeds[seed],
            trials.scenes[scene].id,
        ): trials.traces[row]
        for row, (variant, condition, seed, scene) in zip(rows, places, strict=True)
    }


def _address(row: Row) -> TrialAddress:
    return TrialAddress(*(row[name] for name in _ADDRESS))


def _columns(metrics: Iterable[str]) -> Schema:
    """Return the columns of metrics; one that only some trials have is one too."""
    names = tuple(dict.fromkeys(metrics))
    vehicle = VEHICLE if any(name in VEHICLE for name in names) else ()
    return dict.fromkeys((*vehicle, *names), NUMBER)


def _cells(outcome: Outcome) -> Row:
    time_s = None if outcome.time_s != outcome.time_s else outcome.time_s  # not a number
    return {**outcome.metrics, **vars(outcome), **_axes(outcome.trace), "time_s": time_s}


def _axes(trace: Trace | None) -> Row:
    axes = (None,) * 3 if trace is None else np.asarray(trace, np.float32).T
    return dict(zip(_TRACE, axes, strict=True))


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


def _outcome(row: Mapping[str, Any], trace: Trace | None, untimed: bool = False) -> Outcome:
    """Return the outcome in a row; refuse what no trial leaves behind, whoever wrote it."""
    fields = {name: row[name] for name in ("scene", *_END, *_RESULT)}
    fields["trajectory_hash"] = fields["trajectory_hash"] or ""  # of before there was one
    metrics = {k: v for k, v in row.items() if k not in FIXED and v is not None}
    try:
        fields["status"] = Status(fields["status"])
    except ValueError as error:
        raise Unreadable(str(error)) from error
    unknown = untimed and fields["time_s"] is None
    outcome = Outcome(**fields, trace=trace, metrics=metrics)
    wrong: str | None = None
    if min(outcome.faulted_steps, outcome.altered_steps) < 0:
        wrong = "a count of steps is below 0"
    elif not outcome.failed:
        result = checked(replace(outcome, time_s=1.0) if unknown else outcome, metrics)
        wrong = result.error if result.failed else None
    elif fields["time_s"] is not None and not np.isfinite(fields["time_s"]):
        wrong = "time_s is not finite"
    if wrong:
        raise Unreadable(f"scene '{outcome.scene}': {wrong}")
    return replace(outcome, time_s=math.nan) if unknown and not outcome.failed else outcome
