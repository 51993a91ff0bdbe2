"""Sources of the clearance channel: the geometry itself, or a model of the depth image."""

from abc import ABC, abstractmethod
from functools import lru_cache

from torch import Tensor

from faultpath.quadrotor.chunks import Chunk
from faultpath.quadrotor.perception import DepthClearance, mounted
from faultpath.quadrotor.scenes.field import DistanceField
from faultpath.quadrotor.sensors import Sensors
from faultpath.taps import ModuleTaps


class ClearanceSource(ABC):
    """Says how far points along the candidates are from the nearest surface."""

    name: str
    """Its name in the interface."""

    @abstractmethod
    def look(self, sensors: Sensors, step: int) -> None:
        """Take in what the step brings, once a replan."""

    @abstractmethod
    def query(self, points: Tensor, chunk: Chunk) -> Tensor:
        """Return the clearance `[S, N]`, metres, at `points` `[3, S, N]` (world frame)."""


class TrueClearance(ClearanceSource):
    """The distance field of the geometry: a privileged reference."""

    name = "true_clearance"

    def __init__(self, field: DistanceField) -> None:
        def select(chunk: Chunk) -> DistanceField:
            return field.select(chunk.index)

        self._select = lru_cache(maxsize=64)(select)  # the same scenes at every step

    def look(self, sensors: Sensors, step: int) -> None:
        """Nothing changes: the geometry stands still."""

    def query(self, points: Tensor, chunk: Chunk) -> Tensor:
        """See `ClearanceSource.query`."""
        return self._select(chunk).query(points)


class SeenClearance(ClearanceSource):
    """The perception module behind its taps: what a model makes of the latest depth image."""

    name = "estimated_clearance"

    def __init__(self, model: DepthClearance, taps: ModuleTaps) -> None:
        self._model = model
        self._taps = taps

    def look(self, sensors: Sensors, step: int) -> None:
        """Encode the image that the taps deliver, as seen from the pose that they deliver.

        Where the mount holds the camera follows from the delivered attitude.
        """

        def take(channel: str, place: str) -> Tensor:
            return self._taps.deliver(channel, place, sensors.readings[channel], step)

        attitude = take("attitude", "capture_frame").movedim(0, -1)
        self._model.capture(
            take("depth", "encoder"),
            take("position", "capture_frame"),
            mounted(attitude).movedim(-1, 0),
        )

    def query(self, points: Tensor, chunk: Chunk) -> Tensor:
        """See `ClearanceSource.query`."""
        return self._model.query(points, chunk.index)
