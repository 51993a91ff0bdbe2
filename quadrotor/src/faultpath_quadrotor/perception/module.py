"""The two sources of clearance: the geometry itself, and what a model makes of a depth image."""

from collections.abc import Callable, Sequence
from functools import lru_cache

import torch
from torch import Tensor

from faultpath.loop import Batch, Inputs, Memory, Module, Outputs, Port, Query
from faultpath.plugin.system import Frozen
from faultpath_quadrotor import native
from faultpath_quadrotor.batching import Chunk
from faultpath_quadrotor.device import CPU, host_readable
from faultpath_quadrotor.native.kernel_args import covered, is_exactly, tell_portable, unlike
from faultpath_quadrotor.perception.camera import FOCAL_PX, HEIGHT, WIDTH, captured, mounted
from faultpath_quadrotor.perception.clearance import ClearanceModel
from faultpath_quadrotor.perception.compiled import CompiledClearance, CompiledEncoder
from faultpath_quadrotor.predictors.rollout import Predicted
from faultpath_quadrotor.scenes.field import DistanceField


class PerceptionSettings(Frozen):
    """Settings of perception (derived, docs/design/perception.md)."""

    unseen_m: float = 0.3
    """Most clearance of space outside the field of view: the collision radius and 10 cm. A planner
    may go there where there is nothing better, but would rather look first."""
    near_m: float = 0.4
    """Around the camera the field of view does not matter: the vehicle has just come through."""


class DepthClearance:
    """The clearance that the latest depth images show, for planners that ask about many points.

    It knows nothing but the images and the poses that they were taken from. Points that no pixel
    can show have a clearance of at most `PerceptionSettings.unseen_m`.
    """

    encoder: CompiledEncoder | None = None
    """Compiled encoder of the images, if any, with the weights that the model had then."""
    queries: CompiledClearance | None = None
    """Compiled queries of the model, if any."""

    def __init__(
        self,
        model: ClearanceModel,
        device: torch.device = CPU,
        settings: PerceptionSettings | None = None,
    ) -> None:
        self._model = model.eval()
        self._settings = settings or PerceptionSettings()
        self._captured: tuple[Tensor, Tensor, Tensor] | None = None
        kernels = native.kernels_on(device)
        if kernels is None or not covered(self, DepthClearance):
            return
        if why := _misfit(model):
            tell_portable(f"The clearance model {type(model).__name__}", why)
            return
        known = self._settings
        self.encoder = CompiledEncoder(kernels, model)
        self.queries = CompiledClearance(kernels, model, known.unseen_m, known.near_m)

    @torch.no_grad()
    def capture(self, depth: Tensor, position: Tensor, rotation: Tensor) -> None:
        """Encode the images `[B, 36, 64]` of all scenes, m: once a replan, however often asked.

        They were taken from positions `[B, 3]`, m, by cameras of attitudes `[B, 3, 3]`.
        """
        encode = self._model.encode if self.encoder is None else self.encoder
        self._captured = encode(depth.float()), position.float(), rotation.float()

    @torch.no_grad()
    def query(self, points: Tensor, scenes: Sequence[int] | Tensor) -> Tensor:
        """Return the clearance at points `[3, S, N]` of some scenes, world frame, m: `[S, N]`.

        A scene's values do not depend on which others are asked for. N is a multiple of 32.
        """
        if self._captured is None:
            raise RuntimeError("nothing was captured yet: call `capture` before `query`")
        (codes, position, rotation), index = self._captured, torch.as_tensor(scenes)
        code, pose = codes[:, index].contiguous(), (position[index], rotation[index])
        if self.queries is not None:
            return self.queries(code, *pose, points)
        local = captured(points, *pose)
        clearance, settings = self._model.query(code, local), self._settings
        known = in_view(local) | near(local, settings.near_m)
        return torch.where(known, clearance, clearance.clamp(max=settings.unseen_m))


def in_view(points: Tensor) -> Tensor:
    """Return which points `[3, *b]` of the capture frame the camera's image covers, `[*b]`."""
    x, y, z = points
    left, up = WIDTH / 2 / FOCAL_PX, HEIGHT / 2 / FOCAL_PX
    return (x > 0) & (y.abs() < left * x) & (z.abs() < up * x)


def near(points: Tensor, radius_m: float) -> Tensor:
    """Return which points `[3, *b]` of the capture frame are within `radius_m`, `[*b]`."""
    x, y, z = points
    return (x * x).add_(y * y).add_(z * z) < radius_m**2


def _misfit(model: ClearanceModel) -> str:
    if not is_exactly(model, ClearanceModel):
        return unlike(ClearanceModel, model)
    with torch.device("meta"):
        known = ClearanceModel()
    kinds = [type(part) for part in known.modules()]
    parts = list(model.modules())
    if len(parts) != len(kinds) or not all(map(is_exactly, parts, kinds)):
        return "its layers are others"
    shapes = {name: part.shape for name, part in known.state_dict().items()}
    if str(model) != str(known) or shapes != {n: p.shape for n, p in model.state_dict().items()}:
        return "its layers have other sizes"
    if any(p.dtype != torch.float32 or not host_readable(p.device) for p in model.parameters()):
        return "its weights are not float32 on the CPU"
    return ""


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
