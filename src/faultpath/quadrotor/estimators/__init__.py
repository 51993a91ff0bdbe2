"""Estimators: what the controller knows of the vehicle, and where it has that from."""

from faultpath.quadrotor.estimators.exact import ExactEstimator
from faultpath.quadrotor.estimators.protocol import Estimator

__all__ = ["Estimator", "ExactEstimator"]
