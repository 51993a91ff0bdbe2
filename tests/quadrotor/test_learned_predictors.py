"""WM-A and WM-U: what their shapes and their wiring must hold whatever their weights are."""

import pytest
import torch
from faultpath_quadrotor.predictors import AnchoredPredictor, KinematicIntegrator, PredictorInputs
from faultpath_quadrotor.predictors.rollout import rollout
from faultpath_quadrotor.vehicle import NOMINAL_DRAG_KGPS
from test_native_rollout import commands_of, inputs_of, predictor

SCENES = 5


@pytest.mark.parametrize(("name", "published"), [("wm-a-wind", 17e3), ("wm-u", 35e3)])
def test_models_have_the_papers_size(name, published):
    count = sum(weights.numel() for weights in predictor(name).network.parameters())
    assert abs(count - published) < 0.1 * published


@pytest.mark.parametrize("wind", [True, False])
def test_a_zero_residual_leaves_the_kinematic_integrator_exactly(wind):
    network = AnchoredPredictor.build_network()
    network.initialise(torch.Generator().manual_seed(0))
    anchored = AnchoredPredictor(network, wind, NOMINAL_DRAG_KGPS)
    kinematic = KinematicIntegrator(wind=wind, drag_kgps=NOMINAL_DRAG_KGPS)
    given, drawn = inputs_of(SCENES), commands_of(SCENES, 32)
    rolled, plain = (rollout(model, given, drawn) for model in (anchored, kinematic))
    assert torch.equal(rolled.positions, plain.positions)
    assert torch.equal(rolled.velocities, plain.velocities)
    assert torch.equal(rolled.final.rotation, plain.final.rotation)
    assert torch.equal(rolled.final.rate, plain.final.rate)


@pytest.mark.parametrize("name", ["wm-a-wind", "wm-u"])
def test_every_declared_place_matters_and_no_other(name):
    model, given, drawn = predictor(name), inputs_of(SCENES), commands_of(SCENES, 32)
    plain = rollout(model, given, drawn).positions
    for read in given.delivered:
        other = PredictorInputs(given.state, given.delivered | {read: -1.1 * given[read]})
        moved = not torch.equal(rollout(model, other, drawn).positions, plain)
        assert moved == (read[1] in model.reads and read[1] != "trim"), read
