"""What a report is made from."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from faultpath.errors import UserError
from faultpath.interface import Interface
from faultpath.record.model import DecisionRecord
from faultpath.record.provenance import RunProvenance
from faultpath.trials.floorplan import FloorPlan
from faultpath.trials.shown import VariantShown

TraceKey = tuple[str, str, int, str]
"""`(variant, path, seed, scene)`."""

OUTCOME_COLUMNS = (
    "variant",
    "path",
    "seed",
    "scene",
    "scene_index",
    "topology",
    "status",
    "time_s",
    "terminal_distance_m",
    "min_clearance_m",
    "struck_steps",
    "altered_steps",
    "initial_hash",
    "disturbance_hash",
    "planner_noise_hash",
    "error",
)


@dataclass(frozen=True)
class Traces(Mapping[TraceKey, NDArray[np.float32]]):
    """Flown positions at control steps, `[T, 3]` in metres, world frame; trials may be missing."""

    positions: Mapping[TraceKey, NDArray[np.float32]]
    dt_s: float
    """Seconds between two rows."""

    def __getitem__(self, key: TraceKey) -> NDArray[np.float32]:
        return self.positions[key]

    def __iter__(self) -> Iterator[TraceKey]:
        return iter(self.positions)

    def __len__(self) -> int:
        return len(self.positions)


@dataclass(frozen=True)
class ReportInput:
    """One finished audit: the record, where it came from, and the trials behind it.

    Raises `UserError` when `outcomes` lacks a column.
    """

    record: DecisionRecord
    provenance: RunProvenance
    interface: Interface
    variants: tuple[VariantShown, ...]
    """How baseline and repair are wired."""
    outcomes: pa.Table
    """One row a trial, with the columns of `OUTCOME_COLUMNS`."""
    traces: Traces
    plans: Mapping[str, FloorPlan]
    """By scene id; scenes without one are drawn without obstacles."""

    def __post_init__(self) -> None:
        missing = [c for c in OUTCOME_COLUMNS if c not in self.outcomes.column_names]
        if missing:
            raise UserError(
                f"The outcome table lacks the column {missing[0]!r}; "
                "write it again with this version of faultpath."
            )
