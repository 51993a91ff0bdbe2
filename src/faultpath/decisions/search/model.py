"""The question and the record of a search."""

from typing import Literal

from faultpath.core.results import Result
from faultpath.decisions.model import DecisionRecord
from faultpath.decisions.question import Resolved
from faultpath.decisions.search.bounds import Bounds


class ResolvedSearch(Resolved, allow_inf_nan=False):
    """Question of a search, as its record keeps it."""

    baseline: str
    repair: str
    bounds: Bounds
    """With every size spelled out."""
    candidates: int
    """Proposals; one that was proposed twice was tried once."""
    search_seed: int
    library: str
    library_hash: str
    finding: int
    """Scenes in which faults are tried."""
    confirming: int
    """Other scenes, in which one of them is put to the test."""
    seeds: tuple[int, ...]


class Tried(Result, allow_inf_nan=False):
    """A fault that was tried, as the scenes that find show it. That is no evidence: the best of
    many is chosen by it. Differences are repair minus baseline, pp."""

    fault: str
    isolated_pp: float
    shared_pp: float
    regret_pp: float
    """Loss of the isolated choice under the shared fault, as far as it would be made."""


class SearchRecord(Result, allow_inf_nan=False):
    """A search, with what was confirmed."""

    format: Literal[1] = 1
    question: ResolvedSearch
    tried: tuple[Tried, ...]
    """In the order in which they were proposed."""
    best: str
    """The fault that was put to the test; empty where none showed a reversal."""
    confirmation: str
    """Folder of the confirming audit within that of the search; empty without one."""
    confirmed: DecisionRecord | None
    """Record of the confirming audit, whose scenes had no part in the choice."""
    failed: int
    """Trials that failed, in all scenes."""
    headline: str
    sentences: tuple[str, ...]
    findings: tuple[str, ...] = ()
