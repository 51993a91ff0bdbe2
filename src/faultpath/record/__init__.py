"""The decision: effects, break-even frequency, verdict."""

from faultpath.record.decide import decide, primary_path, stops
from faultpath.record.model import CORRECT, SHARED, DecisionRecord, Path, StruckTap
from faultpath.record.provenance import RunProvenance
from faultpath.record.question import Question, StopRule
from faultpath.record.reproduction import (
    Answer,
    ClaimVerdict,
    Ledger,
    Part,
    Point,
    Reproduction,
    Series,
    Sweep,
)

__all__ = [
    "CORRECT",
    "SHARED",
    "Answer",
    "ClaimVerdict",
    "DecisionRecord",
    "Ledger",
    "Part",
    "Path",
    "Point",
    "Question",
    "Reproduction",
    "RunProvenance",
    "Series",
    "StopRule",
    "StruckTap",
    "Sweep",
    "decide",
    "primary_path",
    "stops",
]
