"""Modules that recover the wind from what the vehicle can measure."""

from faultpath_quadrotor.reconstruction.base import Delivered, Memory, Read, Reconstruction
from faultpath_quadrotor.reconstruction.network import WindNetwork
from faultpath_quadrotor.reconstruction.observer import (
    DisturbanceObserver,
    ObserverMemory,
    Sensed,
)
from faultpath_quadrotor.reconstruction.recurrent import RecurrentMemory, RecurrentReconstruction

__all__ = [
    "Delivered",
    "DisturbanceObserver",
    "Memory",
    "ObserverMemory",
    "Read",
    "Reconstruction",
    "RecurrentMemory",
    "RecurrentReconstruction",
    "Sensed",
    "WindNetwork",
]
