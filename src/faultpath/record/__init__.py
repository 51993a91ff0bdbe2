"""The decision: effects, break-even frequency, verdict."""

from faultpath.record.claim import Answer, ClaimVerdict, Ledger, Part
from faultpath.record.decide import decide, primary_path
from faultpath.record.family import CORRECT, SHARED, Decided, Family, decide_paths
from faultpath.record.model import (
    Cell,
    Change,
    DecisionRecord,
    Effect,
    Generalise,
    Path,
    PathBreakEven,
    Question,
    StruckTap,
    Verdict,
)
from faultpath.record.provenance import RunProvenance
from faultpath.record.reproduction import Configuration, Reproduction, SceneShown
from faultpath.record.table import MISSING, Entry, Line, Point, Series, Sweep, Table

__all__ = [
    "CORRECT",
    "MISSING",
    "SHARED",
    "Answer",
    "Cell",
    "Change",
    "ClaimVerdict",
    "Configuration",
    "Decided",
    "DecisionRecord",
    "Effect",
    "Entry",
    "Family",
    "Generalise",
    "Ledger",
    "Line",
    "Part",
    "Path",
    "PathBreakEven",
    "Point",
    "Question",
    "Reproduction",
    "RunProvenance",
    "SceneShown",
    "Series",
    "StruckTap",
    "Sweep",
    "Table",
    "Verdict",
    "decide",
    "decide_paths",
    "primary_path",
]
