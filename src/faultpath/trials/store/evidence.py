"""Evidence as Parquet: one row a window of a measurement."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from faultpath.core.errors import UserError
from faultpath.core.files.opening import contents
from faultpath.trials.evidence import EvidenceTable, Measured, Measurement
from faultpath.trials.store.atomic import write_file
from faultpath.trials.store.parquet import INTEGER, NUMBER, TEXT, Row, Unreadable, decode, encode

_COLUMNS = {
    "measurement": TEXT,
    "recording": TEXT,
    "quantity": TEXT,
    "subject": TEXT,
    "seed": INTEGER,
    "faults": TEXT,
    "scene": TEXT,
    "step": INTEGER,
    "value": NUMBER,
}


def write_evidence(path: Path, table: EvidenceTable) -> None:
    """Write a table; the bytes depend on the table alone. `UserError` when it cannot be written."""
    write_file(path, encode_evidence(table), path.parent)


def read_evidence(path: Path) -> EvidenceTable:
    """Read a table; `UserError` when there is none to read."""
    try:
        return decode_evidence(contents(path))
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
    return encode(_COLUMNS, _rows(table))


def _rows(table: EvidenceTable) -> Iterator[Row]:
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
        windows = zip(found.scenes, found.steps.tolist(), found.values.tolist(), strict=True)
        for scene, step, value in windows:
            yield {**same, "scene": scene, "step": step, "value": value}


def decode_evidence(data: bytes) -> EvidenceTable:
    """Return the table in a Parquet file's bytes; `Unreadable` when they are none."""
    windows: dict[str, list[tuple[Any, ...]]] = {}
    for row in decode(data, _COLUMNS)[0]:
        windows.setdefault(row["measurement"], []).append((row["scene"], row["step"], row["value"]))
    entries: dict[Measurement, Measured] = {}
    for text, found in windows.items():
        try:
            measurement = Measurement.model_validate_json(text)
        except ValueError as error:
            raise Unreadable("a measurement is not of this version") from error
        scenes, steps, values = zip(*found, strict=True)
        entries[measurement] = Measured(scenes, np.array(steps, np.int64), np.array(values))
    return EvidenceTable(entries)
