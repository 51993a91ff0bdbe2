"""Names that `faultpath.run` offers."""

from faultpath.run.deliveries import Deliveries, RowDeliveries
from faultpath.run.pairing import Group, PairingRefused, Pairs, pair
from faultpath.run.plan import Plan, Row, SystemSpec, Treatment
from faultpath.run.registry import load_system, system_options
from faultpath.run.shown import SystemShown, VariantShown, system_shown
from faultpath.run.trials import Trial, Trials

__all__ = [
    "Deliveries",
    "Group",
    "PairingRefused",
    "Pairs",
    "Plan",
    "Row",
    "RowDeliveries",
    "SystemShown",
    "SystemSpec",
    "Treatment",
    "Trial",
    "Trials",
    "VariantShown",
    "load_system",
    "pair",
    "system_options",
    "system_shown",
]
