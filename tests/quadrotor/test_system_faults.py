"""Faults reach exactly the taps that they name, and the modules cope with what they get."""

import numpy as np
import pytest
from flights import HELD_OUT, STEPS, bits, fault, fly, quadrotor, trace

from faultpath.loop import DeliveryLog
from faultpath.system import Outcome

READERS = ("predictor.dynamics", "predictor.trim", "reconstruction.nominal_model")
WIND_MAPS = ("predictor.wind_map", "reconstruction.wind_map")
ALTERED_BY_CALIBRATION = {("mass", reader): 1 for reader in (*READERS, *WIND_MAPS)}
ALTERED_BY_CALIBRATION |= {("thrust_scale", reader): -1 for reader in READERS}
pytestmark = pytest.mark.usefixtures("short")


@pytest.fixture(scope="module")
def plain(short) -> Outcome:
    return fly(quadrotor(wind="L2"))[0][0]


def _altered(log: DeliveryLog) -> set[tuple[str, str]]:
    return {(tap.channel, tap.reader) for tap in log.taps if tap.steps_altered.any()}


@pytest.mark.parametrize("identity", ["scale=1", "noise=0", "delay=0", "dropout=0"])
def test_an_identity_on_every_channel_is_no_fault_to_the_bit(identity, plain):
    system = quadrotor(wind="L2")
    present = system.variants["dob"].readers
    channels = [c.name for c in system.interface.channels if present & set(c.readers)]
    faults = [part for name in channels for part in fault(f"{name}:{identity}", system)]
    (faulted,), taps = fly(system, faults=faults)
    assert bits(faulted) == bits(plain)
    log = taps.delivery_log()
    assert _altered(log) == set()
    assert all(tap.steps_faulted.all() for tap in log.taps)


def test_calibration_strikes_mass_and_thrust_scale_everywhere_and_nothing_else():
    system = quadrotor(wind="L2")
    _, taps = fly(system, scenes=HELD_OUT[:2], faults=fault("calibration=-0.2", system))
    assert _altered(taps.delivery_log()) == set(ALTERED_BY_CALIBRATION)
    for (channel, reader), deliveries in taps.log.items():
        sign = ALTERED_BY_CALIBRATION.get((channel, reader), 0)
        for reading, value in deliveries:
            assert np.array_equal(value, reading * (1 - 0.2 * sign)), (channel, reader)


def test_a_fault_at_the_observer_leaves_the_inputs_of_the_predictor_clean(plain):
    system = quadrotor(wind="L2")
    (faulted,), taps = fly(system, faults=fault("calibration=0.2@reconstruction", system))
    log = taps.delivery_log()
    observer = {key for key in ALTERED_BY_CALIBRATION if key[1].startswith("reconstruction.")}
    assert _altered(log) == observer
    assert all(log.at(*key).steps_altered[0] == STEPS for key in observer)
    # The observer starts at zero wind whatever its calibration says: the fault needs a step.
    assert np.array_equal(trace(faulted)[1], trace(plain)[1])
    assert not np.array_equal(trace(faulted)[3:], trace(plain)[3:])


TEXTS = (
    "position:noise=0.1",
    "velocity:freeze,onset=3,for=4",
    "attitude:noise=0.05",
    "body_rate:noise=0.3",
    "state:delay=2",
    "action:dropout=0.5",
    "action:erase@vehicle,onset=4",
    "action:delay=1@reconstruction",
    "clearance:erase",
    "goal:offset=0/0.5/0",
    "wind:offset=3/0/0",
    "rollout:noise=0.2",
    "hover:scale=1.2",
)


@pytest.mark.parametrize("text", TEXTS)
def test_a_fault_of_any_channel_flies_and_tells(text, plain):
    system = quadrotor(wind="L2")
    faults = fault(text, system)
    (faulted,), taps = fly(system, faults=faults)
    ends = [faulted.metrics[name] for name in ("terminal_distance_m", "min_clearance_m")]
    assert np.isfinite([*ends, *trace(faulted).flat]).all()
    assert bits(faulted)[-1] != bits(plain)[-1]
    named = {(part.channel, reader) for part in faults for reader in part.readers}
    assert set() < _altered(taps.delivery_log()) <= named
    for hashes in ("initial_hash", "disturbance_hash", "planner_noise_hash"):
        assert getattr(faulted, hashes) == getattr(plain, hashes)
