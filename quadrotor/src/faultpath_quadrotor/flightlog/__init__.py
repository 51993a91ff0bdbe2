"""Recorded flights of real vehicles: what a shared calibration error does to them."""
