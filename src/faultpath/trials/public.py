"""Names that `faultpath.trials` offers."""

from faultpath.trials.checks import library_of
from faultpath.trials.declared import FloorPlan, Library, Pillar, Prism, SceneRef, Variant
from faultpath.trials.deliveries import Deliveries, RowDeliveries
from faultpath.trials.loop_system import LoopSystem, Wiring
from faultpath.trials.options import Offered, Option
from faultpath.trials.outcome import VEHICLE, Metric, Outcome, Status
from faultpath.trials.pairing import Group, PairingRefused, Pairs, pair
from faultpath.trials.plan import Row, Study, SystemSpec, Treatment
from faultpath.trials.registry import load_system, system_options
from faultpath.trials.shown import SystemShown, VariantShown, system_shown
from faultpath.trials.system import ErrorSum, ErrorTerm, System
from faultpath.trials.trials import Trial, Trials

__all__ = [
    "VEHICLE",
    "Deliveries",
    "ErrorSum",
    "ErrorTerm",
    "FloorPlan",
    "Group",
    "Library",
    "LoopSystem",
    "Metric",
    "Offered",
    "Option",
    "Outcome",
    "PairingRefused",
    "Pairs",
    "Pillar",
    "Prism",
    "Row",
    "RowDeliveries",
    "SceneRef",
    "Status",
    "Study",
    "System",
    "SystemShown",
    "SystemSpec",
    "Treatment",
    "Trial",
    "Trials",
    "Variant",
    "VariantShown",
    "Wiring",
    "library_of",
    "load_system",
    "pair",
    "system_options",
    "system_shown",
]
