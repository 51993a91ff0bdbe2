"""Analyses of trials: effects, break-even frequencies, maps, scans, and what they conclude."""

from faultpath.analyses.facts import ComparisonFacts
from faultpath.analyses.model import AuditResult, Condition
from faultpath.run.provenance import RunProvenance
from faultpath.run.question import AuditQuestion

__all__ = ["AuditQuestion", "AuditResult", "ComparisonFacts", "Condition", "RunProvenance"]
