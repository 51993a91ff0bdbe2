"""Models that predict where candidate commands lead."""

from faultpath.quadrotor.predictors.anchored import AnchoredPredictor
from faultpath.quadrotor.predictors.base import (
    Calibration,
    History,
    Memory,
    Physics,
    Predictor,
    PredictorInputs,
)
from faultpath.quadrotor.predictors.kinematic import KinematicIntegrator
from faultpath.quadrotor.predictors.network import LatentNetwork
from faultpath.quadrotor.predictors.true_parameter import TrueParameter
from faultpath.quadrotor.predictors.unanchored import UnanchoredNetwork, UnanchoredPredictor

__all__ = [
    "AnchoredPredictor",
    "Calibration",
    "History",
    "KinematicIntegrator",
    "LatentNetwork",
    "Memory",
    "Physics",
    "Predictor",
    "PredictorInputs",
    "TrueParameter",
    "UnanchoredNetwork",
    "UnanchoredPredictor",
]
