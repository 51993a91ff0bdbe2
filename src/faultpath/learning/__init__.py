"""Repairs as objects: uncertainty training, withholding and reconstruction of any torch module.

A fit gets its inputs through the taps of the system's interface, and the faults of an audit perturb
them. Torch is loaded only when a module is fitted.
"""

from faultpath.learning.fitting import Fit, evaluate, fit, load, mean_squared_error
from faultpath.learning.in_loop import Learned, withheld
from faultpath.learning.matched import Comparison, matched
from faultpath.learning.model_card import FitRecord, Schedule
from faultpath.learning.repair import (
    Repair,
    errors,
    reconstruction,
    uncertainty_training,
    withholding,
)
from faultpath.learning.windows import Windows

__all__ = [
    "Comparison",
    "Fit",
    "FitRecord",
    "Learned",
    "Repair",
    "Schedule",
    "Windows",
    "errors",
    "evaluate",
    "fit",
    "load",
    "matched",
    "mean_squared_error",
    "reconstruction",
    "uncertainty_training",
    "withheld",
    "withholding",
]
