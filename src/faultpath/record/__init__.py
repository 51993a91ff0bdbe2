"""The decision: effects, break-even frequency, verdict."""

from faultpath.record.claim import Answer, ClaimVerdict, Ledger, Part
from faultpath.record.decide import decide
from faultpath.record.model import (
    Cell,
    DecisionRecord,
    Effect,
    Path,
    PathBreakEven,
    Question,
    Reversal,
    StruckTap,
    Verdict,
)
from faultpath.record.provenance import RunProvenance
from faultpath.record.reproduction import Configuration, Reproduction, SceneShown
from faultpath.record.table import MISSING, Entry, Line, Point, Series, Sweep, Table
from faultpath.record.words import CORRECT, SHARED

__all__ = [
    "CORRECT",
    "MISSING",
    "SHARED",
    "Answer",
    "Cell",
    "ClaimVerdict",
    "Configuration",
    "DecisionRecord",
    "Effect",
    "Entry",
    "Ledger",
    "Line",
    "Part",
    "Path",
    "PathBreakEven",
    "Point",
    "Question",
    "Reproduction",
    "Reversal",
    "RunProvenance",
    "SceneShown",
    "Series",
    "StruckTap",
    "Sweep",
    "Table",
    "Verdict",
    "decide",
]
