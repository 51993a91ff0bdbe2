"""The decision: effects, break-even frequency, verdict."""

from faultpath.record.decide import decide
from faultpath.record.model import (
    Cell,
    DecisionRecord,
    Effect,
    Path,
    PathBreakEven,
    Question,
    Reversal,
    Verdict,
)
from faultpath.record.provenance import RunProvenance
from faultpath.record.words import CORRECT, SHARED

__all__ = [
    "CORRECT",
    "SHARED",
    "Cell",
    "DecisionRecord",
    "Effect",
    "Path",
    "PathBreakEven",
    "Question",
    "Reversal",
    "RunProvenance",
    "Verdict",
    "decide",
]
