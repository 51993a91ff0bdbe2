"""The planning core alone, as a flight computer would run it: one vehicle, one replan at a time."""

import torch
from typing_extensions import override

from benchmarks import problem
from benchmarks.replanning import replan
from benchmarks.side import Side
from faultpath.quadrotor.models import clearance_model
from faultpath.quadrotor.options import QuadrotorOptions
from faultpath.quadrotor.perception import DepthClearance, DepthRenderer, mounted
from faultpath.quadrotor.rollout import rolling
from faultpath.quadrotor.scenes.field import DistanceField
from faultpath.quadrotor.scenes.library import load_library


class Latency(Side):
    """Noise, rollout, clearance, costs and update of one vehicle.

    `clearance` is `field`, a query of the baked distance field, or `depth`: the image is encoded
    and the model asked along all candidates. Rendering an image is no work of the vehicle's.
    """

    def __init__(self, clearance: str = "field") -> None:
        torch.set_num_threads(1)
        scene = load_library("selection").scenes[0]
        self._planner = QuadrotorOptions().build_planner()
        self._roll = rolling(problem.model())
        self._inputs = problem.inputs(1)
        self._goal = torch.tensor(scene.goal_m)[:, None]
        self._plan = problem.commands()[..., 0].clone()
        self._step = 0
        self._field = DistanceField.bake(scene) if clearance == "field" else None
        self._seen = DepthClearance(clearance_model())
        state = self._inputs.state
        self._position = state.position[:, 0].T.contiguous()
        self._mount = mounted(state.rotation[..., 0])
        pose = type(state)(*(part[..., 0] for part in vars(state).values()))
        self._image = DepthRenderer([scene]).render(pose)

    @torch.inference_mode()
    @override
    def work(self) -> None:
        self._plan = replan(
            *(self._planner, self._roll, self._inputs, self._plan, self._goal),
            *(["scene/0"], self._step, self._along),
        )
        self._step += 1

    def _along(self, positions: torch.Tensor) -> torch.Tensor:
        return self._clearance(positions.flatten(2)).view(positions.shape[1:])

    def _clearance(self, points: torch.Tensor) -> torch.Tensor:
        if self._field is not None:
            return self._field.query(points)
        self._seen.capture(self._image, self._position, self._mount.movedim(-1, 0))
        return self._seen.query(points, [0])
