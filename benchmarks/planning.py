"""Our sides of the planning comparisons, and the machine's own rate of multiplication."""

from collections.abc import Callable, Sequence

import torch
from torch import Tensor

from benchmarks import problem
from benchmarks.measure import Side
from faultpath.quadrotor.models import clearance_model
from faultpath.quadrotor.options import QuadrotorOptions
from faultpath.quadrotor.perception import DepthClearance, DepthRenderer, mounted
from faultpath.quadrotor.planners import Scored, shift
from faultpath.quadrotor.predictors.rollout import rolling
from faultpath.quadrotor.scenes.field import DistanceField
from faultpath.quadrotor.scenes.library import load_library
from faultpath.quadrotor.state import State
from faultpath.quadrotor.vehicle import GRAVITY_MPS2


def rollout(
    scenes: int = 1, candidates: int = problem.CANDIDATES, steps: int = problem.HORIZON
) -> Side:
    """The candidates of some scenes rolled out; the unit is one scene's."""
    roll, inputs = rolling(problem.model()), problem.inputs(scenes)
    commands = problem.commands(scenes, candidates, steps)

    def answer() -> Sequence[float]:
        """Return positions `[3, H, 32]` of the first scene, m."""
        found = roll(inputs, commands).positions
        return found[:, 0, :, : problem.CHECKED].flatten().tolist()

    return Side(lambda: roll(inputs, commands), scenes, answer)


def replan(scenes: int = 1) -> Side:
    """Noise, rollout, all costs and the update, for some scenes at once.

    The clearance is a constant here: no peer has one. Everything else is the planner of an audit.
    """
    goal = torch.tensor(problem.GOAL_M)[:, None].expand(3, scenes).contiguous()
    near = torch.ones(scenes, problem.HORIZON, problem.CANDIDATES)
    names = [f"scene/{i}" for i in range(scenes)]
    return Side(_replans(names, goal, lambda positions: near), scenes, rollout().answer)


def one_vehicle(clearance: str = "field") -> Side:
    """One vehicle's replan, as a flight computer would run it.

    `clearance` is `field`, a query of the baked distance field, or `depth`: the image is encoded
    and the model asked along all candidates. Rendering an image is no work of the vehicle's.
    """
    scene = load_library("selection").scenes[0]
    state = problem.inputs(1).state
    pose = State(*(part[..., 0] for part in vars(state).values()))
    image = DepthRenderer([scene]).render(pose)
    place, mount = pose.position.T.contiguous(), mounted(pose.rotation).movedim(-1, 0)
    field, seen = DistanceField.bake(scene), DepthClearance(clearance_model())

    def along(positions: Tensor) -> Tensor:
        points = positions.flatten(2)
        if clearance == "field":
            return field.query(points).view(positions.shape[1:])
        seen.capture(image, place, mount)
        return seen.query(points, [0]).view(positions.shape[1:])

    return Side(_replans(["scene/0"], torch.tensor(scene.goal_m)[:, None], along))


def _replans(
    names: Sequence[str], goal: Tensor, clearance: Callable[[Tensor], Tensor]
) -> Callable[[], None]:
    """Return what takes one step of the planner outside the loop, from the step before's plan.

    `clearance` gives `[S, H, K]`, metres, along positions `[3, S, H, K]`.
    """
    planner, roll = QuadrotorOptions().build_planner(), rolling(problem.model())
    inputs = problem.inputs(len(names))
    hover = inputs.trim.hover_thrust(GRAVITY_MPS2)[:, 0]
    plan, step = problem.commands(len(names))[..., 0].clone(), 0

    def work() -> None:
        nonlocal plan, step
        search = planner.init(plan, hover)
        for iteration in range(planner.iterations):
            commands = planner.propose(search, planner.noise(names, 0, step, iteration))
            rolled = roll(inputs, commands)
            near = clearance(rolled.positions)
            search = planner.update(search, Scored(rolled, commands, near, goal, hover))
        plan, step = shift(search.plan), step + 1

    return work


def matrix_product(rows: int = 1024, inner: int = 1024, columns: int = 1024) -> Side:
    """torch's product of two float32 matrices; the unit is a GFLOP."""
    one, other = torch.rand(rows, inner), torch.rand(inner, columns)
    out = torch.empty(rows, columns)
    return Side(lambda: torch.mm(one, other, out=out), 2e-9 * rows * inner * columns)


def gflop_per_replan() -> float:
    """Return the floating-point operations, 1e9, of the network's affine maps in one replan.

    The kinematics and the activations are left out, so that a share of the rate of multiplication
    errs on the low side.
    """
    network = problem.model().network
    layers = [network.embed, network.cell.from_input, network.cell.from_latent]
    layers += [network.first, network.second, network.last]
    each = sum(2 * layer.weight.numel() + layer.bias.numel() for layer in layers)
    return 1e-9 * each * problem.CANDIDATES * problem.HORIZON
