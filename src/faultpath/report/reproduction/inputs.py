"""What the page of a reproduction is made from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from faultpath.interface import Interface
from faultpath.record import DecisionRecord, Ledger, Reproduction
from faultpath.record.provenance import RunProvenance
from faultpath.report.inputs import Traces
from faultpath.report.reproduction.ledger import Limits
from faultpath.tables import Table
from faultpath.trials import FloorPlan, OutcomeTable, VariantShown


@dataclass(frozen=True)
class ReproductionInput:
    """One finished reproduction: what it concludes, and the audit that it shows in detail."""

    reproduction: Reproduction
    provenance: RunProvenance | None
    interface: Interface
    variants: tuple[VariantShown, ...]
    """How baseline and repair of `decision` are wired; empty without one."""
    decision: DecisionRecord | None
    """The audit behind the reversal; `None` where the run does not hold its arms."""
    outcomes: OutcomeTable
    """Trials of that audit, by the paths of its record; others may be among them."""
    traces: Traces
    """Its flights; trials may be missing."""
    plans: Mapping[str, FloorPlan]
    """By scene id; a scene without one is left out of the gallery."""
    beside: tuple[Ledger, ...] = ()
    """What runs on other platforms answered, over the same library."""
    topics: Mapping[str, Sequence[str]] = field(default_factory=dict[str, Sequence[str]])
    """Titles of topics, each with the ids of its claims; claims of none stand last."""
    central: tuple[str, Table] | None = None
    """What became of the paper's central claim here, and where it holds; `None` where the run is
    not about it."""
    limits: Limits = field(default_factory=dict[str, Sequence[Sequence[float]]])
    """What the statements of claims are decided at."""
