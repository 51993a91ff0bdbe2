"""Estimators: what the controller knows of the vehicle, and where it has that from."""

from faultpath.quadrotor.estimators.exact import ExactEstimator

__all__ = ["ExactEstimator"]
