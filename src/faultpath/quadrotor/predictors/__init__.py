"""Models that predict where candidate commands lead."""

from faultpath.quadrotor.predictors.base import (
    Calibration,
    Memory,
    Physics,
    Predictor,
    PredictorInputs,
)
from faultpath.quadrotor.predictors.kinematic import KinematicIntegrator
from faultpath.quadrotor.predictors.true_parameter import TrueParameter

__all__ = [
    "Calibration",
    "KinematicIntegrator",
    "Memory",
    "Physics",
    "Predictor",
    "PredictorInputs",
    "TrueParameter",
]
