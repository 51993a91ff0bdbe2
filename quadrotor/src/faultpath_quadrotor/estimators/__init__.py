"""Estimators: what the controller knows of the vehicle, and from which readings."""

from faultpath_quadrotor.estimators.eskf import ErrorStateFilter
from faultpath_quadrotor.estimators.protocol import Estimator, ExactEstimator
