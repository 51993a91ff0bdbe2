"""The decision: effects, break-even frequency, verdict."""

from faultpath.decisions.model import Condition
from faultpath.decisions.question import Question
from faultpath.decisions.record import DecisionRecord
from faultpath.trials.provenance import RunProvenance

__all__ = ["Condition", "DecisionRecord", "Question", "RunProvenance"]
