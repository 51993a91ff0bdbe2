"""The decision: effects, break-even frequency, verdict."""

from faultpath.decisions.decide import decide, primary_path, stops
from faultpath.decisions.model import CORRECT, SHARED, DecisionRecord, Path, StruckTap
from faultpath.trials.provenance import RunProvenance
from faultpath.decisions.recorded_question import Question, StopRule
from faultpath.decisions.reproduction import (
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
