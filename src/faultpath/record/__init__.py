"""The decision: effects, break-even frequency, verdict."""

from faultpath.record.claim import Answer, ClaimVerdict, Ledger, Part
from faultpath.record.decide import decide, primary_path
from faultpath.record.family import CORRECT, SHARED, Family, decide_paths
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
from faultpath.record.sweep import Point, Series, Sweep

__all__ = [
    "CORRECT",
    "SHARED",
    "Answer",
    "Cell",
    "Change",
    "ClaimVerdict",
    "Configuration",
    "DecisionRecord",
    "Effect",
    "Family",
    "Generalise",
    "Ledger",
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
    "Verdict",
    "decide",
    "decide_paths",
    "primary_path",
]
