"""Inputs of a report."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from faultpath.decisions.model import DecisionRecord
from faultpath.interface import Interface
from faultpath.trials import FloorPlan, OutcomeTable, VariantShown
from faultpath.trials.provenance import RunProvenance
from faultpath.trials.store.signals import Signal, Signals
from faultpath.trials.store.tables import TrialAddress


@dataclass(frozen=True)
class Traces:
    """Positions at control steps; trials may be missing."""

    positions: Mapping[TrialAddress, NDArray[np.float32]]
    """`[T, 3]` each, metres, world frame."""
    dt_s: float
    """Seconds between two rows."""


@dataclass(frozen=True)
class ReportInput:
    """One finished audit: the record, where it came from, and the trials behind it."""

    record: DecisionRecord
    provenance: RunProvenance
    interface: Interface
    variants: tuple[VariantShown, ...]
    """How baseline and repair are wired."""
    outcomes: OutcomeTable
    traces: Traces
    plans: Mapping[str, FloorPlan]
    """By scene id; scenes without one are drawn without obstacles."""
    signals: Signals = field(default_factory=dict[TrialAddress, tuple[Signal, ...]])
    """Signals of the trials of which they were recorded."""
