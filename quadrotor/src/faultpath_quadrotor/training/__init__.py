"""The learned part of the quadrotor: data collection, windows and fitting."""

CLEARANCE_POOL, TRAJECTORY_POOL = "clearance", "trajectory"
"""Names of the pools that are not of training flights."""
