"""The learned part of the quadrotor: data collection, windows and fitting."""
