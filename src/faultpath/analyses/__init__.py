"""The decision: effects, break-even frequency, verdict."""

from faultpath.analyses.facts import Question
from faultpath.analyses.model import Condition
from faultpath.analyses.record import DecisionRecord
from faultpath.run.provenance import RunProvenance

__all__ = ["Condition", "DecisionRecord", "Question", "RunProvenance"]
