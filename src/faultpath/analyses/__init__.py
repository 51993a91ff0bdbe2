"""Analyses of trials: what to run for a question, and the result that follows, in numbers.

An audit begins in `audit` (question to plan) and goes on in `decide` (trials to result), which
calls `family` (all contrasts, tested together); that calls `contrasts` and `missing`. `map` and
`scan` have the same two steps; `judging` pairs trials of other tools for `decide`.
"""

from faultpath.analyses.facts import ComparisonFacts
from faultpath.analyses.model import AuditResult, Condition
from faultpath.run.provenance import RunProvenance
from faultpath.run.question import AuditQuestion

__all__ = ["AuditQuestion", "AuditResult", "ComparisonFacts", "Condition", "RunProvenance"]
