"""The planning problem, WM-A with wind, 512 candidates, 20 steps, and our sides of it.

States, calibrations and commands are drawn about those of flights; the time that a rollout takes
does not depend on them.
"""

from collections.abc import Callable

import torch
from faultpath_quadrotor import native, so3
from faultpath_quadrotor.models import clearance_model, predictor
from faultpath_quadrotor.options import QuadrotorOptions
from faultpath_quadrotor.perception import DepthClearance, DepthRenderer, mounted
from faultpath_quadrotor.planners import AutoregressiveSampler, SamplerSettings, Scored, shift
from faultpath_quadrotor.predictors import AnchoredPredictor, PredictorInputs
from faultpath_quadrotor.predictors.rollout import rolling
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.state import State
from torch import Tensor

from benchmarks.side import Side
from faultpath.core.streams import generator

CANDIDATES = 512
HORIZON = 20
CHECKED = 32
"""Candidates whose positions are compared between planners."""
DRAG_KGPS = 0.3
"""Alike along all axes, so that peers may write it as a constant force."""
GOAL_M = (6.0, 0.5, 1.2)


def model() -> AnchoredPredictor:
    """Return the shipped predictor, seed 0, with `DRAG_KGPS`."""
    shipped = predictor("wm-a-wind", 0)
    assert isinstance(shipped, AnchoredPredictor)
    return AnchoredPredictor(shipped.network, wind=True, drag_kgps=(DRAG_KGPS,) * 3)


CALIBRATED = ("trim", "dynamics")


def inputs() -> PredictorInputs:
    """Return the readings that taps would deliver for one scene, batch `[1, 1]`, float32."""
    draw = generator("benchmark", "scene/0", 0)

    def column(rows: int, low: float, high: float) -> Tensor:
        return torch.from_numpy(draw.uniform(low, high, (rows, 1))).float()[..., None]

    mass_kg, thrust_scale = column(1, 0.8, 1.2)[0], column(1, 0.8, 1.2)[0]
    return PredictorInputs(
        state=State(
            position=column(3, 1.0, 2.0),
            velocity=column(3, -2.0, 2.0),
            rotation=so3.exp(column(3, -0.4, 0.4)),
            rate=column(3, -1.0, 1.0),
        ),
        delivered={
            **{("mass", place): mass_kg for place in (*CALIBRATED, "wind_map", "normalise_thrust")},
            **{("thrust_scale", place): thrust_scale for place in CALIBRATED},
            ("wind", "wind_map"): column(3, -5.0, 5.0),
            ("history_code", "latent"): column(32, -0.8, 0.8),
        },
    )


def commands() -> Tensor:
    """Return candidates about hover, `[H, 4, 1, K]`."""
    sampler = AutoregressiveSampler(SamplerSettings(candidates=CANDIDATES, horizon=HORIZON))
    hover = inputs().hover_thrust
    plan = torch.zeros(HORIZON, 4, 1)
    plan[:, 0] = hover
    with native.using(native.PORTABLE):  # the same numbers for every side
        return sampler.candidates(plan, hover, sampler.noise(["scene/0"], 0, 0))


def positions() -> list[float]:
    """Return the positions that every planner must predict, `[3, H, 32]` flat, m."""
    predicted = rolling(model())(inputs(), commands()).positions
    return predicted[:, 0, :, :CHECKED].flatten().tolist()


def rollout() -> Side:
    """The candidates of one scene rolled out."""
    roll, readings, candidates = rolling(model()), inputs(), commands()
    return Side(lambda: roll(readings, candidates))


def replan() -> Side:
    """Noise, rollout, all costs and the update for one scene.

    The clearance is a constant here: no peer has one. Everything else is the planner of an audit.
    """
    near = torch.ones(1, HORIZON, CANDIDATES)
    return Side(_replans(torch.tensor(GOAL_M)[:, None].contiguous(), lambda positions: near))


def one_vehicle() -> Side:
    """One vehicle's replan, as a flight computer would run it.

    The depth image is encoded and the model asked along all candidates; rendering an image is no
    work of the vehicle's.
    """
    scene = load_library("selection").scenes[0]
    pose = State(*(part[..., 0] for part in vars(inputs().state).values()))
    image = DepthRenderer([scene]).render(pose)
    place, mount = pose.position.T.contiguous(), mounted(pose.rotation).movedim(-1, 0)
    seen = DepthClearance(clearance_model())

    def along(positions: Tensor) -> Tensor:
        seen.capture(image, place, mount)
        return seen.query(positions.flatten(2), [0]).view(positions.shape[1:])

    return Side(_replans(torch.tensor(scene.goal_m)[:, None], along))


def _replans(goal: Tensor, clearance: Callable[[Tensor], Tensor]) -> Callable[[], None]:
    """Return a function that takes one step of the planner, from the plan of the step before.

    `clearance` gives `[1, H, K]`, metres, along positions `[3, 1, H, K]`.
    """
    planner, roll, readings = QuadrotorOptions().build_planner(), rolling(model()), inputs()
    hover = readings.hover_thrust
    plan, step = commands()[..., 0].clone(), 0

    def work() -> None:
        nonlocal plan, step
        search = planner.init(plan, hover)
        for iteration in range(planner.iterations):
            candidates = planner.propose(search, planner.noise(["scene/0"], 0, step, iteration))
            rolled = roll(readings, candidates)
            near = clearance(rolled.positions)
            search = planner.update(search, Scored(rolled, candidates, near, goal, hover))
        plan, step = shift(search.plan), step + 1

    return work


def network_product() -> Side:
    """torch's product of two square matrices that counts as many operations as a rollout.

    Only the network's affine maps count: kinematics and activations are left out, so that a
    rollout's share of the rate of multiplication errs on the low side.
    """
    network = model().network
    layers = [network.embed, network.cell.from_input, network.cell.from_latent]
    layers += [network.first, network.second, network.last]
    operations = sum(2 * layer.weight.numel() + layer.bias.numel() for layer in layers)
    one, other, out = torch.rand(1024, 1024), torch.rand(1024, 1024), torch.empty(1024, 1024)
    rollouts = 2 * 1024**3 / (operations * CANDIDATES * HORIZON)
    return Side(lambda: torch.mm(one, other, out=out), rollouts)
