"""Names that `faultpath.trials` offers."""

from faultpath.trials.arm import Arm, Row, Study, SystemSpec
from faultpath.trials.checks import library_of
from faultpath.trials.declared import FloorPlan, Library, Pillar, Prism, SceneRef, Variant
from faultpath.trials.loop_system import LoopSystem, Wiring
from faultpath.trials.options import Offered, Option
from faultpath.trials.outcome import VEHICLE, Metric, Outcome, Status
from faultpath.trials.pairing import PairingRefused, Pairs, Side, pair
from faultpath.trials.registry import load_system, system_options
from faultpath.trials.shown import SystemShown, VariantShown, system_shown
from faultpath.trials.system import ErrorSum, ErrorTerm, System
from faultpath.trials.table import Deliveries, OutcomeTable, RowDeliveries, TrialRow

__all__ = [
    "VEHICLE",
    "Arm",
    "Deliveries",
    "ErrorSum",
    "ErrorTerm",
    "FloorPlan",
    "Library",
    "LoopSystem",
    "Metric",
    "Offered",
    "Option",
    "Outcome",
    "OutcomeTable",
    "PairingRefused",
    "Pairs",
    "Pillar",
    "Prism",
    "Row",
    "RowDeliveries",
    "SceneRef",
    "Side",
    "Status",
    "Study",
    "System",
    "SystemShown",
    "SystemSpec",
    "TrialRow",
    "Variant",
    "VariantShown",
    "Wiring",
    "library_of",
    "load_system",
    "pair",
    "system_options",
    "system_shown",
]
