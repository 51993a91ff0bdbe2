"""WM-A and WM-U: what their shapes and their wiring must hold whatever their weights are."""

import pytest
import torch
from faultpath_quadrotor.predictors import (
    AnchoredPredictor,
    KinematicIntegrator,
    PredictorInputs,
    UnanchoredPredictor,
)
from faultpath_quadrotor.predictors.rollout import rollout
from faultpath_quadrotor.vehicle import NOMINAL_DRAG_KGPS
from test_native_rollout import commands_of, inputs_of

SCENES = 5
KINDS = [AnchoredPredictor, UnanchoredPredictor]


def network(kind, seed=0, lively=True):
    """Return a network with drawn weights; `lively` ones have a last layer that is not zero."""
    generator = torch.Generator().manual_seed(seed)
    built = kind.build_network()
    built.initialise(generator)
    if lively:
        with torch.no_grad():
            built.last.weight.normal_(0, 0.2, generator=generator)
    return built


def predictor(kind, seed=0, lively=True, **options):
    if kind is AnchoredPredictor:
        options = {"wind": True, "drag_kgps": NOMINAL_DRAG_KGPS, **options}
    return kind(network(kind, seed, lively), **options)


@pytest.mark.parametrize(
    ("kind", "published"), [(AnchoredPredictor, 17e3), (UnanchoredPredictor, 35e3)]
)
def test_models_have_the_papers_size(kind, published):
    count = sum(weights.numel() for weights in network(kind).parameters())
    assert abs(count - published) < 0.1 * published


@pytest.mark.parametrize("wind", [True, False])
def test_a_zero_residual_leaves_the_kinematic_integrator_exactly(wind):
    anchored = predictor(AnchoredPredictor, lively=False, wind=wind)
    plain = rollout(
        KinematicIntegrator(wind=wind, drag_kgps=NOMINAL_DRAG_KGPS),
        inputs_of(SCENES),
        commands_of(SCENES, 512),
    )
    rolled = rollout(anchored, inputs_of(SCENES), commands_of(SCENES, 512))
    assert torch.equal(rolled.positions, plain.positions)
    assert torch.equal(rolled.velocities, plain.velocities)
    assert torch.equal(rolled.final.rotation, plain.final.rotation)
    assert torch.equal(rolled.final.rate, plain.final.rate)


@pytest.mark.parametrize("kind", KINDS)
def test_a_scene_does_not_depend_on_the_scenes_beside_it(kind):
    model, given, drawn = predictor(kind), inputs_of(SCENES), commands_of(SCENES, 512)
    together = rollout(model, given, drawn)
    for scenes in ([2], [4, 1, 0]):
        alone = rollout(model, given.take(scenes), drawn[:, :, scenes].contiguous())
        assert torch.equal(alone.positions, together.positions[:, scenes])


def _moved(model, given, read):
    plain = rollout(model, given, commands_of(SCENES, 512)).positions
    other = PredictorInputs(given.state, given.delivered | {read: -1.1 * given[read]})
    return not torch.equal(rollout(model, other, commands_of(SCENES, 512)).positions, plain)


@pytest.mark.parametrize("kind", KINDS)
def test_every_declared_place_matters_and_no_other(kind):
    model, given = predictor(kind), inputs_of(SCENES)
    for read in given.delivered:
        matters = read[1] in model.reads and read[1] != "trim"
        assert _moved(model, given, read) == matters, read
