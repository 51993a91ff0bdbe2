"""Analytic predictors and the observer against closed forms; what learned ones hold to."""

import math
from dataclasses import replace

import pytest
import torch
from faultpath_quadrotor import so3
from faultpath_quadrotor.predictors import (
    AnchoredPredictor,
    KinematicIntegrator,
    Physics,
    PredictorInputs,
    TrueParameter,
)
from faultpath_quadrotor.predictors.kinematic import LinearDrag
from faultpath_quadrotor.predictors.rollout import rollout
from faultpath_quadrotor.reconstruction import DisturbanceObserver
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import (
    CONTROL_DT_S,
    GRAVITY_MPS2,
    NOMINAL_DRAG_KGPS,
    NOMINAL_INERTIA_KGM2,
    NOMINAL_MOTOR_TIME_CONSTANT_S,
)
from test_native_rollout import commands_of, inputs_of, predictor

HORIZON, DT = 20, 0.05
F64, REST = torch.float64, (0.0, 0.0, 0.0)


def inputs(mass=1.0, scale=1.0, wind=REST, velocity=REST, thrust=9.81, drag=NOMINAL_DRAG_KGPS):
    column = torch.ones(1, 1, dtype=F64)

    def three(values):
        return torch.tensor(values, dtype=F64).view(3, 1, 1)

    state = replace(State.hover(three(REST), 0 * column), velocity=three(velocity))
    lag_s = NOMINAL_MOTOR_TIME_CONSTANT_S * column
    inertia = three(NOMINAL_INERTIA_KGM2)
    physics = Physics(inertia, column, lag_s, three(drag), thrust * column)
    delivered = {("mass", place): mass * column for place in ("trim", "dynamics", "wind_map")}
    delivered |= {("thrust_scale", place): scale * column for place in ("trim", "dynamics")}
    code = torch.zeros(32, 1, 1, dtype=F64)
    code[12:16] = thrust  # of motors that were told so for long
    delivered |= {("wind", "wind_map"): three(wind), ("history_code", "latent"): code}
    delivered |= {("physics", "physics"): physics.reading()}
    return PredictorInputs(state, delivered)


def commands(thrust, rates=REST):
    return torch.tensor([thrust, *rates], dtype=F64).view(1, 4, 1, 1).expand(HORIZON, 4, 1, 4)


STILL_AIR = KinematicIntegrator(drag_kgps=NOMINAL_DRAG_KGPS)
DRAGGED = KinematicIntegrator(drag=True, drag_kgps=NOMINAL_DRAG_KGPS)
PREDICTORS = [STILL_AIR, DRAGGED, TrueParameter()]


@pytest.mark.parametrize("predictor", PREDICTORS)
def test_hover_thrust_of_the_calibration_holds_the_vehicle(predictor):
    given = inputs(mass=1.3, scale=0.8, thrust=1.3 * GRAVITY_MPS2 / 0.8)
    hover = float(given.hover_thrust)
    end = rollout(predictor, given, commands(hover)).final
    assert end.position.abs().max() < 1e-9


@pytest.mark.parametrize("error", [-0.1, 0.1])
def test_calibration_error_scales_thrust_and_wind_pushes_by_the_nominal_linear_map(error):
    """Thrust acceleration scales by (1 - e)/(1 + e), and wind adds R (c o R^T w)/m~ (paper, IV)."""
    readings = inputs(mass=1 + error, scale=1 - error, wind=(2.0, -1.0, 4.0))
    end = rollout(STILL_AIR, readings, commands(GRAVITY_MPS2)).velocities[:, 0, -1, 0]
    expected = 0.30 * torch.tensor([2.0, -1.0, 4.0], dtype=F64) / (1 + error)
    expected[2] += GRAVITY_MPS2 * ((1 - error) / (1 + error) - 1)
    torch.testing.assert_close(end, expected * HORIZON * DT)


def test_drag_and_the_lag_of_the_rate_have_their_closed_forms():
    readings = inputs(velocity=(3.0, 0.0, 0.0))
    rolled = rollout(DRAGGED, readings, commands(GRAVITY_MPS2, (0.0, 0.0, 1.0)))
    exact = 3.0 * math.exp(-0.30 * HORIZON * DT)
    assert float(rolled.velocities[0, 0, -1, 0]) == pytest.approx(exact, rel=0.01)
    time, lag = HORIZON * DT, 0.05
    angle = time + lag * math.expm1(-time / lag)
    assert float(so3.log(rolled.final.rotation)[2, 0, 0]) == pytest.approx(angle)


def test_true_parameter_follows_a_thrust_step_with_the_motor_lag():
    readings = inputs(thrust=0.0, drag=(0.0, 0.0, 0.0))
    rolled = rollout(TrueParameter(), readings, commands(GRAVITY_MPS2))
    # From still motors, gravity acts until the thrust is there: the loss of speed tends to
    # g times the motor time constant.
    lost_mps = GRAVITY_MPS2 * NOMINAL_MOTOR_TIME_CONSTANT_S
    assert float(rolled.velocities[2, 0, 4, 0]) == pytest.approx(-lost_mps, rel=0.01)


LANES = 32


def delivered(seed, mass, scale):
    draw = torch.Generator().manual_seed(seed)
    one = torch.ones(LANES, dtype=torch.float64)

    def normal(*shape):
        return torch.randn(*shape, LANES, generator=draw, dtype=torch.float64)

    thrust = 9.81 + normal(1)
    return {
        ("velocity", "velocity_difference"): normal(3),
        ("attitude", "nominal_model"): so3.exp(0.4 * normal(3)),
        ("action", "nominal_model"): torch.cat([thrust, normal(3)]),
        ("mass", "nominal_model"): mass * one,
        ("thrust_scale", "nominal_model"): scale * one,
        ("mass", "wind_map"): mass * one,
    }


@pytest.mark.parametrize(("mass", "scale"), [(1.0, 1.0), (1.1, 0.9), (0.9, 1.1)])
def test_unfiltered_estimate_recombines_to_the_observed_acceleration(mass, scale, monkeypatch):
    """a_0 + B w_raw = a_obs whatever the calibration (paper, Eq. 2)."""
    monkeypatch.setattr("faultpath_quadrotor.reconstruction.observer.LOW_PASS", 1.0)
    observer = DisturbanceObserver(NOMINAL_DRAG_KGPS)
    first, second = (delivered(seed, mass=mass, scale=scale) for seed in (1, 2))
    wind = observer.wind(observer.update(observer.begin(first), second))
    pushed = LinearDrag(NOMINAL_DRAG_KGPS).force(second["attitude", "nominal_model"], wind) / mass
    read = ("velocity", "velocity_difference")
    observed = (second[read] - first[read]) / CONTROL_DT_S
    torch.testing.assert_close(observer.nominal(second) + pushed, observed)


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
    given, drawn = inputs_of(), commands_of()
    rolled, plain = (rollout(model, given, drawn) for model in (anchored, kinematic))
    assert torch.equal(rolled.positions, plain.positions)
    assert torch.equal(rolled.velocities, plain.velocities)
    assert torch.equal(rolled.final.rotation, plain.final.rotation)
    assert torch.equal(rolled.final.rate, plain.final.rate)


@pytest.mark.parametrize("name", ["wm-a-wind", "wm-u"])
def test_every_declared_place_matters_and_no_other(name):
    model, given, drawn = predictor(name), inputs_of(), commands_of()
    plain = rollout(model, given, drawn).positions
    for read in given.delivered:
        other = PredictorInputs(given.state, given.delivered | {read: -1.1 * given[read]})
        moved = not torch.equal(rollout(model, other, drawn).positions, plain)
        assert moved == (read[1] in model.reads and read[1] != "trim"), read
