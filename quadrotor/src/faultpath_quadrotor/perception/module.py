"""The two sources of clearance: the geometry itself, and what a model makes of a depth image.

Both are queries: a planner asks where its candidates lead, as often as it wants.
"""

from collections.abc import Callable
from functools import lru_cache

from torch import Tensor

from faultpath.loop import Batch, Inputs, Memory, Module, Outputs, Port, Query
from faultpath_quadrotor.batching import Chunk
from faultpath_quadrotor.perception import DepthClearance, mounted
from faultpath_quadrotor.predictors.rollout import Predicted
from faultpath_quadrotor.scenes.field import DistanceField

Measure = Callable[[Tensor, Chunk], Tensor]
"""The clearance `[S, N]`, metres, at points `[3, S, N]` (world frame) of a chunk's scenes."""


def clearance_query(measure: Measure) -> Query:
    """Return the query that answers with the clearance along all candidates, `[B, H, K]`."""

    def answer(predicted: Predicted) -> Tensor:
        first = predicted.rollouts[0].positions
        clearance = first.new_zeros(predicted.count, *first.shape[2:])
        for chunk, rollout in zip(predicted.chunks, predicted.rollouts, strict=True):
            points = rollout.positions
            clearance[chunk.rows] = measure(points.flatten(2), chunk).view(points.shape[1:])
        return clearance

    return Query(answer)


def geometric_clearance(field: DistanceField) -> Query:
    """Return the clearance of the geometry: a privileged reference."""

    @lru_cache(maxsize=64)  # the same scenes at every step
    def select(chunk: Chunk) -> DistanceField:
        return field.select(chunk.index)

    return clearance_query(lambda points, chunk: select(chunk).query(points))


class Perception(Module):
    """Clearance from the latest depth image, as seen from the pose that the taps deliver."""

    name, writes = "perception", ("estimated_clearance",)

    reads = frozenset(
        {
            Port("depth", "encoder"),
            Port("position", "capture_frame"),
            Port("attitude", "capture_frame"),
        }
    )

    def __init__(self, model: Callable[[], DepthClearance]) -> None:
        self._model = model

    def begin(self, batch: Batch) -> DepthClearance:
        """Return the model, which holds the latest image."""
        del batch
        return self._model()

    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Encode the image. Where the mount holds the camera follows from the attitude."""
        model: DepthClearance = memory
        attitude = inputs["attitude", "capture_frame"].movedim(0, -1)
        model.capture(
            inputs["depth", "encoder"],
            inputs["position", "capture_frame"],
            mounted(attitude).movedim(-1, 0),
        )

        def measure(points: Tensor, chunk: Chunk) -> Tensor:
            return model.query(points, chunk.index)

        return {"estimated_clearance": clearance_query(measure)}, model
