"""Estimators: what the controller knows of the vehicle, and where it has that from."""

from faultpath_quadrotor.estimators.eskf import FILTERS, ErrorStateFilter, Tuned, filtering
from faultpath_quadrotor.estimators.protocol import Estimator, ExactEstimator
