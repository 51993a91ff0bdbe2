"""What `faultpath.trials` offers."""

from faultpath.trials.arm import Arm, Row, Study, SystemSpec
from faultpath.trials.checks import library_of
from faultpath.trials.declared import FloorPlan, Library, Pillar, Prism, SceneRef, Variant
from faultpath.trials.deliveries import Deliveries, RowDeliveries
from faultpath.trials.looped import LoopSystem, Wiring
from faultpath.trials.metrics import Metric
from faultpath.trials.options import Offered, Option
from faultpath.trials.outcome import Outcome, Status
from faultpath.trials.pairing import PairingRefused, Pairs, Side, pair
from faultpath.trials.registry import load_system, system_options
from faultpath.trials.shown import SystemShown, VariantShown, system_shown
from faultpath.trials.system import System
from faultpath.trials.table import OutcomeTable, TrialRow
from faultpath.trials.terms import ErrorSum, ErrorTerm

__all__ = [
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
