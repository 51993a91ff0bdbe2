"""The decision: effects, break-even frequency, verdict."""

from faultpath.decisions.model import DecisionRecord, Path
from faultpath.decisions.question import Question
from faultpath.trials.provenance import RunProvenance

__all__ = ["DecisionRecord", "Path", "Question", "RunProvenance"]
