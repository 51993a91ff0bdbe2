"""The estimator is a slot: a filter in a file of the user's flies, and nothing of ours changes."""

from pathlib import Path

import numpy as np
import pytest
from flights import HELD_OUT, bits, fault, fly, quadrotor

from faultpath.core.errors import UserError

FILTER = f"{Path(__file__).parents[2] / 'examples' / 'own_filter.py'}:create"


@pytest.fixture(autouse=True)
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("faultpath_quadrotor.plant.module.CONTROL_STEPS", 30)


def test_a_filter_of_ones_own_estimates_the_state():
    system = quadrotor(estimator=FILTER, wind="L1")
    (exact,), true = fly(quadrotor(wind="L1"))
    (flown,), taps = fly(system)
    assert "Estimating: Filter of" in system.variants["dob"].description
    for channel, close in (("position", 0.05), ("velocity", 0.3), ("attitude", 0.05)):
        known = taps.delivered(channel, "predictor.initial_state")[:10]
        assert np.abs(known - true.delivered(channel, "predictor.initial_state")[:10]).max() < close
    assert bits(flown) != bits(exact)
    assert flown.disturbance_hash == exact.disturbance_hash
    noisy, _ = fly(quadrotor(estimator=FILTER, wind="L1", sensor_noise="1"))
    assert bits(noisy[0]) != bits(flown)


def test_faults_reach_the_sensors_of_an_estimator_and_variants_may_differ_in_it():
    system = quadrotor(bring=FILTER, wind="L1")
    assert {FILTER, f"{FILTER}/dob", "dob"} < set(system.variants)
    assert "estimator.filter" in system.variants[FILTER].consumers
    assert "estimator.filter" not in system.variants["dob"].consumers
    biased = fault("gyroscope:offset=0.2/0/0", system)
    plain, _ = fly(system, f"{FILTER}/dob", HELD_OUT[:1])
    faulted, _ = fly(system, f"{FILTER}/dob", HELD_OUT[:1], [biased])
    assert bits(faulted[0]) != bits(plain[0])


def test_raw_sensors_that_nobody_reads_change_nothing():
    (one,), _ = fly(quadrotor(bring=FILTER, sensor_noise="1"))
    (other,), _ = fly(quadrotor())
    assert bits(one) == bits(other)


def test_an_estimator_that_writes_elsewhere_is_refused(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(
        "from faultpath_quadrotor.estimators import Estimator\n"
        "class Odd(Estimator):\n    writes = ('mission_goal',)\n"
        "    def step(self, inputs, memory):\n        return {}, memory\n"
        "def create(seed):\n    return Odd()\n"
    )
    with pytest.raises(UserError, match="'mission_goal', which is no source of an estimator"):
        quadrotor(estimator=f"{path}:create")
