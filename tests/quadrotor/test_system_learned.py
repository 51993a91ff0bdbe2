"""The controller with its learned modules: who reads what, and what a fault on it does."""

import numpy as np
import pytest
from faultpath_quadrotor.choices import STATE_NOISE_STD
from faultpath_quadrotor.device import CPU
from faultpath_quadrotor.models import predictor, reconstruction
from faultpath_quadrotor.plant.protocol import Vehicle
from faultpath_quadrotor.variants import variants
from flights import HELD_OUT, fault, fly, quadrotor

STEPS = 5
LEARNED = {"predictor": "wm-a-wind", "clearance": "depth", "wind": "L2"}
pytestmark = pytest.mark.usefixtures("short")


def test_a_variants_seed_chooses_the_training_of_what_its_variant_names():
    found = {parts.name: parts for parts in variants(quadrotor(**LEARNED).options)}
    assert found["gru"].load_reconstruction(2) is reconstruction("gru", 2, CPU)
    assert found["gru"].load_predictor(2) is predictor("wm-a-wind", 0, CPU)
    assert found["wm-a"].load_predictor(2) is predictor("wm-a", 2, CPU)
    assert found["wm-a-wind/gru"].load_predictor(2) is predictor("wm-a-wind", 2, CPU)
    others = variants(quadrotor(**LEARNED, predictor_seed="1").options)
    other = {parts.name: parts for parts in others}
    assert other["gru"].load_predictor(2) is predictor("wm-a-wind", 1, CPU)


def test_a_noisy_state_is_late_and_the_same_for_everyone():
    system = quadrotor(**LEARNED)
    _, taps = fly(system, "gru", faults=fault("noisy_state=1", system))
    for channel in STATE_NOISE_STD:
        readers = [reader for name, reader in taps.log if name == channel]
        assert len(readers) > 1
        got = [taps.delivered(channel, reader) for reader in readers]
        assert all(np.array_equal(value, got[0]) for value in got)
    truth = np.stack([reading for reading, _ in taps.log["velocity", "predictor.history"]])
    late = taps.delivered("velocity", "predictor.history")[2:] - truth[1:-1]
    assert 0.2 * STATE_NOISE_STD["velocity"] < late.std() < 3 * STATE_NOISE_STD["velocity"]
    position = taps.delivered("position", "predictor.initial_state")[2:]
    true = np.stack([reading for reading, _ in taps.log["position", "predictor.initial_state"]])
    error = position - true[1:-1]
    assert abs(np.corrcoef(error.ravel(), late.ravel())[0, 1]) < 0.9


def test_calibration_errors_reach_the_predictor_s_history_but_not_the_hover_before_the_flight():
    """Whatever calibration is believed: the command of the past is not the one it would give."""
    system = quadrotor(**LEARNED)
    _, taps = fly(system, "gru", faults=fault("calibration=0.1@predictor", system))
    taps_logged = taps.delivery_log().taps
    places = {t.reader for t in taps_logged if t.channel == "mass" and t.steps_altered.any()}
    readers = ("dynamics", "wind_map", "trim", "normalise_thrust", "history")
    assert places == {f"predictor.{reader}" for reader in readers}
    hover = Vehicle.stack([system.scene(HELD_OUT[0]).vehicle]).hover_command().T
    for reader in ("predictor.history", "reconstruction.history"):
        assert np.array_equal(taps.delivered("action", reader)[0], hover.numpy())
