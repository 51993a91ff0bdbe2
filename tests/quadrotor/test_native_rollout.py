"""The compiled horizon loop and recurrent unit are the portable ones, to rounding."""

from itertools import product

import pytest
import torch
from faultpath_quadrotor import native, so3
from faultpath_quadrotor.predictors import (
    AnchoredPredictor,
    KinematicIntegrator,
    Predictor,
    PredictorInputs,
    UnanchoredNetwork,
    UnanchoredPredictor,
)
from faultpath_quadrotor.predictors.network import GatedCell, draw_weights
from faultpath_quadrotor.predictors.rollout import Roll, Rollout, rolling, rollout
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import NOMINAL_DRAG_KGPS

TOLERANCE = 1e-5
SCENES = 3


def random_weights(module: torch.nn.Module, seed: int = 0) -> None:
    """Fill weights and statistics so that outputs are of the size of trained ones."""
    stream = torch.Generator().manual_seed(seed)
    with torch.no_grad():
        for name, value in (*module.named_parameters(), *module.named_buffers()):
            value.uniform_(-0.25, 0.25, generator=stream)
            if name.endswith("_std"):
                value.abs_().add_(0.6 if name == "feature_std" else 0.01)


def predictor(name: str) -> Predictor:
    if name.startswith("dki"):
        drag, wind = name == "dki-drag", name != "dki-still"
        return KinematicIntegrator(drag, wind, drag_kgps=NOMINAL_DRAG_KGPS)
    if name == "wm-u":
        unanchored = UnanchoredNetwork()
        random_weights(unanchored)
        return UnanchoredPredictor(unanchored)
    anchored = AnchoredPredictor.build_network()
    random_weights(anchored)
    return AnchoredPredictor(anchored, name == "wm-a-wind", NOMINAL_DRAG_KGPS)


def inputs_of(scenes: int = SCENES, seed: int = 1) -> PredictorInputs:
    stream = torch.Generator().manual_seed(seed)

    def draw(*shape: int, low: float = -1.0, high: float = 1.0) -> torch.Tensor:
        return torch.empty(*shape, scenes, 1).uniform_(low, high, generator=stream)

    state = State(draw(3), 2 * draw(3), so3.exp(draw(3)), draw(3))

    calibrated = [
        *product(("mass", "thrust_scale"), ("trim", "dynamics", "features")),
        ("mass", "wind_map"),
        ("mass", "normalise_thrust"),
    ]
    delivered = {read: draw(low=0.6, high=1.4) for read in calibrated}
    delivered |= {("wind", "wind_map"): 5 * draw(3), ("history_code", "latent"): draw(32)}
    return PredictorInputs(state, delivered)


def commands_of(scenes: int = SCENES, candidates: int = 96) -> torch.Tensor:
    stream = torch.Generator().manual_seed(2)
    commands = torch.randn(20, 4, scenes, candidates, generator=stream)
    commands[:, 0] = (9.8 + 3 * commands[:, 0]).clamp_(min=0)
    return commands


def ends_of(rolled: Rollout) -> tuple[torch.Tensor, ...]:
    return rolled.positions, rolled.velocities, rolled.final.rotation, rolled.final.rate


NAMES = ["dki", "dki-drag", "dki-still", "wm-a", "wm-a-wind", "wm-u"]


def compiled(isa: str, model: Predictor) -> Roll:
    with native.using(isa):
        return rolling(model)


@torch.inference_mode()
@pytest.mark.parametrize("name", NAMES)
def test_compiled_equals_portable_and_a_candidate_depends_on_no_other(isa: str, name: str) -> None:
    model, given, commands = predictor(name), inputs_of(), commands_of()
    roll = compiled(isa, model)
    ours, theirs = roll(given, commands), rollout(model, given, commands)
    for mine, reference in zip(ends_of(ours), ends_of(theirs), strict=True):
        torch.testing.assert_close(mine, reference, rtol=TOLERANCE, atol=TOLERANCE)
    # Nor on how many there are: not even on whether they fill a tile.
    some = roll(given.take([1]), commands[:, :, 1:2, 5:42].contiguous())
    assert torch.equal(ours.positions[:, 1:2, :, 5:42], some.positions)
    assert torch.equal(ours.final.rotation[:, :, 1:2, 5:42], some.final.rotation)


def cell_and_sequence(inputs: int, columns: int) -> tuple[GatedCell, torch.Tensor]:
    stream = torch.Generator().manual_seed(inputs)
    cell = GatedCell(inputs, 32)
    draw_weights(cell, stream)
    return cell, 2 * torch.randn(12, inputs, columns, generator=stream)


@pytest.mark.parametrize("inputs", [19, 22, 32])
def test_the_last_latent_is_the_portable_one_and_that_of_the_gru_of_torch(isa: str, inputs: int):
    cell, sequence = cell_and_sequence(inputs, columns=5)
    with torch.enable_grad():  # the way by which training goes
        portable = cell.last(sequence).detach()
    assert portable.std() > 0.1
    given, kept = ((layer.weight, layer.bias) for layer in (cell.from_input, cell.from_latent))
    with native.using(isa), torch.inference_mode():
        compiled = cell.last(sequence)
    torch.testing.assert_close(compiled, portable, rtol=1e-5, atol=1e-5)
    reference = torch.nn.GRU(inputs, 32)
    weights = (given[0], kept[0], given[1][:, 0], kept[1][:, 0])
    reference.load_state_dict(dict(zip(reference.state_dict(), weights, strict=True)))
    torch.testing.assert_close(reference(sequence.movedim(2, 1))[1][0].T, portable)
