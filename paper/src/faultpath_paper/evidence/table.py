"""Evidence measured on recorded windows: measurements, their values, and the table as Parquet,
with one row per window of a measurement.

No tensors and no simulator here: `quantities` measures, and all others read the table.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from faultpath.core.errors import UserError
from faultpath.core.files.atomic import write_file
from faultpath.core.files.opening import contents
from faultpath.core.files.parquet import INTEGER, NUMBER, TEXT, Unreadable, decode, encode
from faultpath.core.results import Frozen

Quantity: TypeAlias = Literal[
    "position-error",
    "position-response",
    "shuffle-response",
    "acceleration-error",
    "wind-term-error",
]

QUANTITIES: Mapping[Quantity, str] = {
    "position-error": "m",
    "position-response": "m",
    "shuffle-response": "m",
    "acceleration-error": "m/s^2",
    "wind-term-error": "m/s^2",
}
"""Unit of each quantity. `docs/design/studies.md` gives their formulas."""


class Recording(Frozen):
    """Closed-loop flights under correct inputs, whose windows are measured.

    How many scenes fly is decided when they are measured: the first N of the library.
    """

    library: str
    """Name of a library, or the path of its file."""
    variant: str
    """Variant that flies."""
    seed: int = 0
    options: dict[str, str] = Field(default_factory=dict[str, str])
    """Options of the system, as in `SystemSpec`."""

    @property
    def name(self) -> str:
        """Return a readable name of its own, such as `held-out:true-parameter:0:wind-L3`."""
        parts = [self.library, self.variant, str(self.seed)]
        if self.options:
            parts.append(",".join(f"{key}-{value}" for key, value in sorted(self.options.items())))
        return ":".join(parts)

    def __hash__(self) -> int:
        """Hash by name, since options have no hash."""
        return hash(self.name)


class Measurement(Frozen):
    """A quantity of one variant on the windows of a recording, window by window."""

    recording: Recording
    quantity: Quantity
    subject: str
    """Variant that is measured: a predictor and what feeds its wind input, as in treatments."""
    seed: int = 0
    """Seed of the training of what the variant names, and of the faults' random numbers."""
    faults: tuple[str, ...] = ()
    """Faults as the command line writes them, for example `calibration=+0.1@predictor`."""

    def key(self) -> str:
        """Content hash: equal measurements have equal keys, on every machine."""
        content = json.dumps(self.model_dump(mode="json"), sort_keys=True)
        return hashlib.sha256(content.encode()).hexdigest()[:16]

    def __hash__(self) -> int:
        """Hash by content, as `key`."""
        return hash(self.key())


@dataclass(frozen=True, eq=False)
class Measured:
    """One measurement: its W windows in the order of their scenes, then of their time."""

    scenes: tuple[str, ...]
    """Id of the scene that each window was recorded in, `[W]`."""
    steps: NDArray[np.int64]
    """Control step of each window's present, `[W]`."""
    values: NDArray[np.float64]
    """The quantity, `[W]`, in the unit that `QUANTITIES` gives."""

    def __len__(self) -> int:
        return len(self.scenes)

    def same_windows(self, other: "Measured") -> bool:
        """Return whether both are of the same windows in the same order, so that they pair."""
        return self.scenes == other.scenes and np.array_equal(self.steps, other.steps)


EvidenceTable: TypeAlias = dict[Measurement, Measured]
"""Everything that was measured."""


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
    """Write a table, measurements in its order; the bytes depend on the table alone.

    `measurement` is the measurement as JSON, from which it is read back; the other
    columns repeat it for other readers of the file. `UserError` when it cannot be written.
    """
    rows: list[dict[str, Any]] = []
    for measurement, measured in table.items():
        common = {
            "measurement": measurement.model_dump_json(),
            "recording": measurement.recording.name,
            "quantity": measurement.quantity,
            "subject": measurement.subject,
            "seed": measurement.seed,
            "faults": " ".join(measurement.faults),
        }
        steps, values = measured.steps.tolist(), measured.values.tolist()
        windows = zip(measured.scenes, steps, values, strict=True)
        rows += [{**common, "scene": s, "step": step, "value": value} for s, step, value in windows]
    write_file(path, encode(_COLUMNS, rows), path.parent)


def read_evidence(path: Path) -> EvidenceTable:
    """Read a table; `UserError` when there is none to read."""
    windows: dict[str, list[tuple[Any, ...]]] = {}
    entries: dict[Measurement, Measured] = {}
    try:
        for row in decode(contents(path), _COLUMNS)[0]:
            rows = windows.setdefault(row["measurement"], [])
            rows.append((row["scene"], row["step"], row["value"]))
        for text, rows in windows.items():
            scenes, steps, values = zip(*rows, strict=True)
            measured = Measured(scenes, np.array(steps, np.int64), np.array(values))
            entries[Measurement.model_validate_json(text)] = measured
    except OSError as error:
        raise UserError(
            f"cannot read {path} ({error.strerror}): measure it first, or check the path"
        ) from error
    except (Unreadable, ValueError) as error:
        reason = error if isinstance(error, Unreadable) else "it is not of this version"
        raise UserError(f"{path} is damaged ({reason}): delete it and measure again") from None
    return EvidenceTable(entries)
