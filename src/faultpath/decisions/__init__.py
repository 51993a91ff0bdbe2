"""The decision: effects, break-even frequency, verdict."""

from faultpath.decisions.model import Path
from faultpath.decisions.question import Question
from faultpath.decisions.record import DecisionRecord
from faultpath.trials.provenance import RunProvenance

__all__ = ["DecisionRecord", "Path", "Question", "RunProvenance"]
