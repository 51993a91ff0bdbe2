"""Depth perception: the camera, what it sees, and the clearance that can be told from it."""

from faultpath.quadrotor.perception.camera import CaptureFrame, mounted
from faultpath.quadrotor.perception.clearance import ClearanceModel
from faultpath.quadrotor.perception.labels import visible_distance
from faultpath.quadrotor.perception.render import DepthRenderer
from faultpath.quadrotor.perception.seen import DepthClearance, PerceptionSettings

__all__ = [
    "CaptureFrame",
    "ClearanceModel",
    "DepthClearance",
    "DepthRenderer",
    "PerceptionSettings",
    "mounted",
    "visible_distance",
]
