"""The decision: effects, break-even frequency, verdict."""

from faultpath.decisions.decide import decide, primary_path, stops
from faultpath.decisions.model import CORRECT, SHARED, DecisionRecord, Path, StruckTap
from faultpath.decisions.question import Question, StopRule
from faultpath.trials.provenance import RunProvenance

__all__ = [
    "CORRECT",
    "SHARED",
    "DecisionRecord",
    "Path",
    "Question",
    "RunProvenance",
    "StopRule",
    "StruckTap",
    "decide",
    "primary_path",
    "stops",
]
