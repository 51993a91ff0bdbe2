"""The decision: effects, break-even frequency, verdict."""

from faultpath.record.decide import decide, primary_path
from faultpath.record.family import CORRECT, SHARED, decide_paths
from faultpath.record.model import (
    Change,
    DecisionRecord,
    Effect,
    Generalise,
    Path,
    PathBreakEven,
    Question,
    StruckTap,
)
from faultpath.record.provenance import RunProvenance
from faultpath.record.reproduction import (
    Answer,
    ClaimVerdict,
    Configuration,
    Ledger,
    Part,
    Point,
    Reproduction,
    SceneShown,
    Series,
    Sweep,
)

__all__ = [
    "CORRECT",
    "SHARED",
    "Answer",
    "Change",
    "ClaimVerdict",
    "Configuration",
    "DecisionRecord",
    "Effect",
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
    "decide",
    "decide_paths",
    "primary_path",
]
