"""Modules that recover the wind from what the vehicle can measure."""

from faultpath.quadrotor.reconstruction.base import Memory, Reconstruction, Sensed
from faultpath.quadrotor.reconstruction.observer import DisturbanceObserver, ObserverMemory

__all__ = ["DisturbanceObserver", "Memory", "ObserverMemory", "Reconstruction", "Sensed"]
