"""Models that predict where candidate commands lead."""

from faultpath_quadrotor.predictors.anchored import AnchoredPredictor
from faultpath_quadrotor.predictors.base import Memory, Physics, Predictor, PredictorInputs
from faultpath_quadrotor.predictors.kinematic import KinematicIntegrator
from faultpath_quadrotor.predictors.network import LatentNetwork
from faultpath_quadrotor.predictors.true_parameter import TrueParameter
from faultpath_quadrotor.predictors.unanchored import UnanchoredNetwork, UnanchoredPredictor
