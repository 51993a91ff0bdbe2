"""The decision: effects, break-even frequency, verdict."""

from faultpath.decisions.decide import decide, primary_path, stops
from faultpath.decisions.model import CORRECT, SHARED, DecisionRecord, FaultedTap, Path
from faultpath.decisions.question import Question, StopRule
from faultpath.trials.provenance import RunProvenance

__all__ = [
    "CORRECT",
    "SHARED",
    "DecisionRecord",
    "FaultedTap",
    "Path",
    "Question",
    "RunProvenance",
    "StopRule",
    "decide",
    "primary_path",
    "stops",
]
