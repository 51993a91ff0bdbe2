"""The planning core alone, as a flight computer would run it: one vehicle, one replan at a time."""

import torch

from benchmarks import problem
from benchmarks.side import Side
from faultpath.quadrotor.models import clearance_model
from faultpath.quadrotor.options import QuadrotorOptions
from faultpath.quadrotor.perception import DepthClearance, DepthRenderer, mounted
from faultpath.quadrotor.planner import shift
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
        self._planner = QuadrotorOptions().build_planner(problem.model())
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
    def work(self) -> None:
        """See `Side.work`."""
        noise = self._planner.sampler.noise(["scene/0"], 0, self._step)
        proposal = self._planner.propose(self._inputs, self._plan, noise)
        points = proposal.rollout.positions
        clearance = self._clearance(points.flatten(2)).view(points.shape[1:])
        self._plan = shift(self._planner.decide(proposal, clearance, self._goal))
        self._step += 1

    def _clearance(self, points: torch.Tensor) -> torch.Tensor:
        if self._field is not None:
            return self._field.query(points)
        self._seen.capture(self._image, self._position, self._mount.movedim(-1, 0))
        return self._seen.query(points, [0])
