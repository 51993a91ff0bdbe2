"""Modules that recover the wind from what the vehicle can measure."""

from faultpath_quadrotor.batching import Delivered, Read
from faultpath_quadrotor.reconstruction.base import Memory, Reconstruction
from faultpath_quadrotor.reconstruction.network import (
    RecurrentMemory,
    RecurrentReconstruction,
    WindNetwork,
)
from faultpath_quadrotor.reconstruction.observer import (
    DisturbanceObserver,
    InertialObserver,
    ObserverMemory,
)
