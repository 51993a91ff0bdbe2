"""The estimator is a slot: a filter in a file of the user's flies, and nothing of ours changes."""

from pathlib import Path

import numpy as np
import pytest
from faultpath_quadrotor.state_errors import TURNING, state_errors
from flights import HELD_OUT, bits, fault, fly, quadrotor

from faultpath.core.errors import UserError
from faultpath.faults import encode_record

STILL = {"attitude": np.eye(3)}
FILTER = f"{Path(__file__).parents[2] / 'examples' / 'own_filter.py'}:create"
STEPS = 20
pytestmark = pytest.mark.usefixtures("short")


def test_filters_estimate_the_state_and_feed_every_reader():
    (exact,), true = fly(quadrotor(wind="L1"))
    for estimator, said in ((FILTER, "Filter of"), ("eskf", "a Kalman filter")):
        system = quadrotor(estimator=estimator, wind="L1", sensor_noise="0")
        (flown,), taps = fly(system)
        assert f"Estimating: {said}" in system.variants["dob"].description
        for channel, close in (("position", 0.05), ("velocity", 0.3), ("attitude", 0.05)):
            known = taps.delivered(channel, "predictor.initial_state")[:10]
            truth = true.delivered(channel, "predictor.initial_state")[:10]
            assert np.abs(known - truth).max() < close
        assert bits(flown) != bits(exact)
        assert flown.disturbance_hash == exact.disturbance_hash
    noisy, _ = fly(quadrotor(estimator="eskf", wind="L1", sensor_noise="1"))
    assert bits(noisy[0]) != bits(flown)


def test_a_filter_that_ships_flies_with_usual_sensors_and_beside_its_kin():
    assert quadrotor(estimator="eskf").options.sensor_noise == 1.0
    assert quadrotor().options.sensor_noise == 0.0
    system = quadrotor(estimator="eskf", wind="L1")
    assert {"dob-inertial", "eskf-no-bias/dob", "eskf-cautious/gru"} < set(system.variants)
    assert "dob-inertial" not in quadrotor(wind="L1").variants
    far = quadrotor(estimator="eskf", wind="L1", fixes="satellite")
    flights = (system, "dob-inertial"), (system, "eskf-no-bias/dob-inertial"), (far, "dob-inertial")
    assert len({bits(fly(flyer, variant)[0][0]) for flyer, variant in flights}) == 3


def test_errors_of_one_flight_are_delivered_to_one_module_of_another(tmp_path):
    system = quadrotor(estimator="eskf-no-bias", wind="L1")
    turned = fault("mount=0.1", system)
    record = state_errors(system, "dob", HELD_OUT[:2], 0, turned)
    again = state_errors(system, "dob", HELD_OUT[:2], 0, [])
    for key, each in again.items():
        assert np.abs(each - STILL.get(key.channel, 0.0)).max() < 1e-5
    path = tmp_path / "errors.parquet"
    path.write_bytes(encode_record(record, TURNING))
    alone = fault(f"state:recorded={path}@reconstruction", system)
    _, taps = fly(system, "dob", HELD_OUT[:2], alone)
    channel, place = "velocity", "reconstruction.velocity_difference"
    for index, scene in enumerate(HELD_OUT[:2]):
        given, got = np.stack([[x[index] for x in pair] for pair in taps.log[channel, place]], 1)
        wrong = record[channel, scene, 0]
        count = min(len(wrong), len(got))
        assert np.abs(wrong[-1]).max() > 0.02
        assert np.abs(got[:count] - given[:count] - wrong[:count]).max() < 1e-6
    for given, got in taps.log[channel, "predictor.initial_state"]:
        assert (given == got).all()


def test_faults_reach_the_sensors_of_an_estimator_and_variants_may_differ_in_it():
    system = quadrotor(bring=FILTER, wind="L1", sensor_noise="1")
    assert "estimator.filter" in system.variants[FILTER].readers
    assert "estimator.filter" not in system.variants["dob"].readers
    biased = fault("gyroscope:offset=0.2/0/0", system)
    plain, _ = fly(system, f"{FILTER}/dob")
    faulted, _ = fly(system, f"{FILTER}/dob", faults=biased)
    assert bits(faulted[0]) != bits(plain[0])
    assert bits(fly(system)[0][0]) == bits(fly(quadrotor(wind="L1"))[0][0]), "nobody reads sensors"


def test_an_estimator_that_writes_elsewhere_or_keeps_no_filter_is_refused(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(
        "from faultpath_quadrotor.estimators import Estimator\n"
        "class Odd(Estimator):\n    writes = ('mission_goal',)\n"
        "    def step(self, inputs, memory):\n        return {}, memory\n"
        "def create(seed) -> 'Predictor':\n    return Odd()\n"
    )
    with pytest.raises(UserError, match="'mission_goal', which is no source of an estimator"):
        quadrotor(estimator=f"{path}:create")
    with pytest.raises(UserError, match="no filter whose errors could be recorded"):
        state_errors(quadrotor(), "dob", HELD_OUT[:1], 0, [])
