"""Our sides of the planning comparisons, and the machine's own rate of multiplication."""

from collections.abc import Sequence

import torch
from typing_extensions import override

from benchmarks import problem
from benchmarks.replanning import replan
from benchmarks.side import Side
from faultpath.quadrotor import rollout as horizon
from faultpath.quadrotor.options import QuadrotorOptions
from faultpath.quadrotor.planner import SamplerSettings


class Rollout(Side):
    """The candidates of some scenes rolled out; the unit is one scene's."""

    def __init__(
        self,
        scenes: int = 1,
        candidates: int = problem.CANDIDATES,
        steps: int = problem.HORIZON,
    ) -> None:
        torch.set_num_threads(1)
        self.amount = scenes
        self._roll = horizon.rolling(problem.model())
        self._inputs = problem.inputs(scenes)
        self._commands = problem.commands(scenes, candidates, steps)

    @torch.inference_mode()
    @override
    def work(self) -> None:
        self._roll(self._inputs, self._commands)

    @torch.inference_mode()
    def answer(self) -> Sequence[float]:
        """Return positions `[3, H, 32]` of the first scene, m."""
        found = self._roll(self._inputs, self._commands).positions
        return found[:, 0, :, : problem.CHECKED].flatten().tolist()


class Replan(Side):
    """Noise, rollout, all costs and the update, for some scenes at once.

    The clearance is a constant here: no peer has one. Everything else is the planner of an audit.
    """

    def __init__(self, scenes: int = 1) -> None:
        torch.set_num_threads(1)
        self.amount = scenes
        self._planner = QuadrotorOptions().build_planner()
        self._roll = horizon.rolling(problem.model())
        settings: SamplerSettings = self._planner.sampler.settings
        self._inputs = problem.inputs(scenes)
        self._scenes = [f"scene/{i}" for i in range(scenes)]
        self._goal = torch.tensor(problem.GOAL_M)[:, None].expand(3, scenes).contiguous()
        self._clearance = torch.ones(scenes, settings.horizon, settings.candidates)
        self._step = 0
        self._plan = problem.commands(scenes)[..., 0].clone()

    @torch.inference_mode()
    @override
    def work(self) -> None:
        self._plan = replan(
            *(self._planner, self._roll, self._inputs, self._plan, self._goal),
            *(self._scenes, self._step, lambda positions: self._clearance),
        )
        self._step += 1

    def answer(self) -> Sequence[float]:
        """See `Rollout.answer`: the same predictor."""
        return Rollout().answer()


class MatrixProduct(Side):
    """torch's product of two square float32 matrices of 1024 rows; the unit is a GFLOP."""

    def __init__(self, rows: int = 1024, inner: int = 1024, columns: int = 1024) -> None:
        torch.set_num_threads(1)
        self.amount = 2e-9 * rows * inner * columns
        self._a, self._b = torch.rand(rows, inner), torch.rand(inner, columns)
        self._out = torch.empty(rows, columns)

    @torch.inference_mode()
    @override
    def work(self) -> None:
        torch.mm(self._a, self._b, out=self._out)


def flops_per_replan() -> float:
    """Return the floating-point operations of the network's affine maps in one replan.

    The kinematics and the activations are left out, so that a share of the rate of multiplication
    errs on the low side.
    """
    network = problem.model().network
    layers = [network.embed, network.cell.from_input, network.cell.from_latent]
    layers += [network.first, network.second, network.last]
    each = sum(2 * layer.weight.numel() + layer.bias.numel() for layer in layers)
    return float(each * problem.CANDIDATES * problem.HORIZON)
