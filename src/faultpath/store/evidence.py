"""Evidence as Parquet: one row a window of a measurement."""

from pathlib import Path
from typing import Any

import numpy as np

from faultpath.errors import UserError
from faultpath.evidence import EvidenceTable, Measured, Measurement
from faultpath.store import atomic
from faultpath.store.parquet import Column, Kind, Unreadable, decode, encode

_COLUMNS = (
    Column("measurement", Kind.TEXT),
    Column("recording", Kind.TEXT),
    Column("quantity", Kind.TEXT),
    Column("subject", Kind.TEXT),
    Column("seed", Kind.INTEGER),
    Column("faults", Kind.TEXT),
    Column("scene", Kind.TEXT),
    Column("step", Kind.INTEGER),
    Column("value", Kind.NUMBER),
)


def write_evidence(path: Path, table: EvidenceTable) -> None:
    """Write a table; the bytes depend on the table alone. `UserError` when it cannot be written."""
    try:
        atomic.write(path, encode_evidence(table), path.parent)
    except OSError as error:
        raise UserError(
            f"cannot write {path} ({error.strerror}): choose a place that you may write to"
        ) from error


def read_evidence(path: Path) -> EvidenceTable:
    """Read a table; `UserError` when there is none to read."""
    try:
        return decode_evidence(path.read_bytes())
    except OSError as error:
        raise UserError(
            f"cannot read {path} ({error.strerror}): measure it first, or check the path"
        ) from error
    except Unreadable as error:
        raise UserError(f"{path} is damaged ({error}): delete it and measure again") from None


def encode_evidence(table: EvidenceTable) -> bytes:
    """Return a table as a Parquet file, measurements in the table's order.

    `measurement` is the measurement as JSON, from which it is read back; the columns beside it say
    the same to whoever opens the file with something else.
    """
    values: dict[str, list[Any]] = {column.name: [] for column in _COLUMNS}
    for measurement in table:
        found = table.values(measurement)
        same = {
            "measurement": measurement.model_dump_json(),
            "recording": measurement.recording.name,
            "quantity": measurement.quantity,
            "subject": measurement.subject,
            "seed": measurement.seed,
            "faults": " ".join(measurement.faults),
        }
        for name, value in same.items():
            values[name] += [value] * len(found)
        values["scene"] += found.scenes
        values["step"] += found.steps.tolist()
        values["value"] += found.values.tolist()
    return encode(_COLUMNS, values)


def decode_evidence(data: bytes) -> EvidenceTable:
    """Return the table in a Parquet file's bytes; `Unreadable` when they are none."""
    columns = decode(data, _COLUMNS)
    rows: dict[str, list[int]] = {}
    for row, text in enumerate(columns["measurement"]):
        rows.setdefault(text, []).append(row)
    entries: dict[Measurement, Measured] = {}
    for text, chosen in rows.items():
        try:
            measurement = Measurement.model_validate_json(text)
        except ValueError as error:
            raise Unreadable("a measurement is not of this version") from error
        entries[measurement] = Measured(
            scenes=tuple(columns["scene"][row] for row in chosen),
            steps=np.array([columns["step"][row] for row in chosen], dtype=np.int64),
            values=np.array([columns["value"][row] for row in chosen], dtype=np.float64),
        )
    return EvidenceTable(entries)
