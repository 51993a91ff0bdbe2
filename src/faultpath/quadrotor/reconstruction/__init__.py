"""Modules that recover the wind from what the vehicle can measure."""

from faultpath.quadrotor.reconstruction.base import Delivered, Memory, Read, Reconstruction
from faultpath.quadrotor.reconstruction.network import WindNetwork
from faultpath.quadrotor.reconstruction.observer import (
    DisturbanceObserver,
    ObserverMemory,
    Sensed,
)
from faultpath.quadrotor.reconstruction.recurrent import RecurrentMemory, RecurrentReconstruction

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
