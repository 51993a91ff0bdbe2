"""A kernel stands for exactly what it repeats; anything else flies as it is, and that is said."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from types import MethodType
from typing import Any

import pytest
import torch
from faultpath_quadrotor import native
from faultpath_quadrotor.native.kernel_args import PortableNotice, tell_portable
from faultpath_quadrotor.perception import ClearanceModel, DepthClearance
from faultpath_quadrotor.planners import NavigationCost, Scored
from faultpath_quadrotor.predictors import (
    AnchoredPredictor,
    KinematicIntegrator,
    LatentNetwork,
    Memory,
    Predictor,
)
from faultpath_quadrotor.predictors.compiled import HorizonLoop, uncovered
from faultpath_quadrotor.predictors.kinematic import LinearDrag
from faultpath_quadrotor.predictors.rollout import rolling, rollout
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import NOMINAL_DRAG_KGPS
from test_native_planner import scored
from test_native_rollout import commands_of, inputs_of, predictor, random_weights
from torch import Tensor, nn

SHIFT_M = 100.0
"""No shipped predictor leads so far."""

pytestmark = pytest.mark.skipif(not native.available(), reason="nothing was compiled")


@pytest.fixture(autouse=True)
def _nothing_said_yet() -> Iterator[None]:
    tell_portable.cache_clear()
    yield
    tell_portable.cache_clear()


def moved(ahead: State) -> State:
    return replace(ahead, position=ahead.position + SHIFT_M)


def shifted(self: Any, *given: Any) -> tuple[State, Memory]:
    ahead, memory = AnchoredPredictor.step(self, *given)
    return moved(ahead), memory


class Anchored(AnchoredPredictor):
    step = shifted


class Integrator(KinematicIntegrator):
    def advance(self, *given: object, **named: object) -> State:
        return moved(super().advance(*given, **named))


def anchored_on(network: LatentNetwork) -> AnchoredPredictor:
    return AnchoredPredictor(network, True, NOMINAL_DRAG_KGPS)


def stepping_otherwise() -> Predictor:
    model = predictor("wm-a-wind")
    vars(model)["step"] = MethodType(shifted, model)
    return model


def on_kinematics(kinematics: KinematicIntegrator) -> Predictor:
    model = predictor("wm-a-wind")
    assert isinstance(model, AnchoredPredictor)
    model.kinematics = kinematics
    return model


OWN: dict[str, Callable[[], Predictor]] = {
    "anchored": lambda: Anchored(predictor("wm-a").network, True, NOMINAL_DRAG_KGPS),
    "kinematic": lambda: Integrator(drag_kgps=NOMINAL_DRAG_KGPS),
    "a step of its own on the instance": stepping_otherwise,
    "kinematics of its own": lambda: on_kinematics(Integrator(drag_kgps=NOMINAL_DRAG_KGPS)),
}


@torch.inference_mode()
@pytest.mark.parametrize("make", OWN.values(), ids=OWN)
def test_a_step_of_ones_own_is_what_flies(make: Callable[[], Predictor]) -> None:
    own = make()
    with pytest.warns(PortableNotice, match=r"runs on the portable path.* there is a kernel|were"):
        seen = rolling(own)(inputs_of(), commands_of())
    assert float(seen.positions[..., -1, :].min()) > SHIFT_M
    assert torch.equal(seen.positions, rollout(own, inputs_of(), commands_of()).positions)


class OtherNetwork(LatentNetwork):
    pass


class OtherDrag(LinearDrag):
    pass


def with_other_drag() -> Predictor:
    integrator = KinematicIntegrator(drag_kgps=NOMINAL_DRAG_KGPS)
    integrator.air = OtherDrag(NOMINAL_DRAG_KGPS)
    return integrator


REASONS: dict[str, tuple[Callable[[], Predictor], str]] = {
    "one unit too many": (lambda: anchored_on(LatentNetwork(129, 6)), "128 hidden units, not 129"),
    "more outputs": (lambda: anchored_on(LatentNetwork(64, 17)), "layer 'last'"),
    "other inputs": (lambda: anchored_on(LatentNetwork(64, 6, conditioning=40)), "'first'"),
    "network": (lambda: anchored_on(OtherNetwork(64, 6)), "not of OtherNetwork"),
    "drag": (with_other_drag, "not of OtherDrag"),
}


@pytest.mark.parametrize(("make", "why"), REASONS.values(), ids=REASONS)
def test_what_the_kernel_cannot_stand_for_is_refused_with_a_reason(make, why):
    model = make()
    assert uncovered(model)
    with pytest.raises(ValueError, match=why):
        HorizonLoop(native.load(native.available()[0]), model)


@torch.inference_mode()
@pytest.mark.parametrize("hidden", [1, 126, 128])
def test_every_size_that_the_kernel_can_hold_is_computed(hidden: int) -> None:
    network = LatentNetwork(hidden, 6)
    random_weights(network)
    model = anchored_on(network)
    given, commands = inputs_of(), commands_of()
    assert not uncovered(model)
    roll = rolling(model)
    ours, theirs = roll(given, commands), rollout(model, given, commands)
    torch.testing.assert_close(ours.positions, theirs.positions, rtol=1e-4, atol=1e-4)


class OwnClearance(ClearanceModel):
    pass


def encoding(layers: dict[int, nn.Module]) -> ClearanceModel:
    model = ClearanceModel()
    for index, layer in layers.items():
        model.encoder[index] = layer
    return model


@pytest.mark.parametrize(
    ("model", "why"),
    [
        (OwnClearance(), "not of Own"),
        (encoding({7: nn.Linear(48 * 5 * 8, 256), 9: nn.Linear(256, 64)}), "other sizes"),
        (encoding({1: nn.Tanh()}), "layers are others"),
    ],
)
def test_a_clearance_model_of_ones_own_is_what_answers(model: ClearanceModel, why: str) -> None:
    with pytest.warns(PortableNotice, match=why):
        assert DepthClearance(model).queries is None
    assert DepthClearance(ClearanceModel()).queries is not None


def test_a_cost_of_ones_own_is_what_decides() -> None:
    class OwnCost(NavigationCost):
        def _heading(self, scored: Scored) -> Tensor:
            return torch.full_like(super()._heading(scored), 1e6)

    with pytest.warns(PortableNotice, match="not of Own"):
        assert float(OwnCost()(scored(torch.Generator().manual_seed(0), 16)).min()) > 1e5
