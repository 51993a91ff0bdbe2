"""Inputs of a report."""

from dataclasses import dataclass, field

from faultpath.analyses.model import AuditResult
from faultpath.run.provenance import RunProvenance
from faultpath.run.shown import SystemShown
from faultpath.run.store.signals import Signal, Signals
from faultpath.run.store.tables import TrialAddress
from faultpath.run.trials import Trials


@dataclass(frozen=True)
class ReportInput:
    """One finished audit: the result, where it came from, and the trials behind it."""

    record: AuditResult
    provenance: RunProvenance
    system: SystemShown
    """Interface, how baseline and repair are wired, and floor plans."""
    trials: Trials
    """The trials, with their positions where the system gives any."""
    signals: Signals = field(default_factory=dict[TrialAddress, tuple[Signal, ...]])
    """Signals of the trials of which they were recorded."""
