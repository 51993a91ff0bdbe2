"""Depth perception: the camera, its images, and the clearance that they show."""

from faultpath_quadrotor.perception.camera import mounted
from faultpath_quadrotor.perception.clearance import ClearanceModel
from faultpath_quadrotor.perception.labels import visible_distance
from faultpath_quadrotor.perception.module import DepthClearance, PerceptionSettings
from faultpath_quadrotor.perception.render import DepthRenderer
