"""What a recorded flight of the quadrotor says, and that its errors are the paper's."""

import numpy as np
import pytest
from flights import fault

from faultpath.faults import at_readers
from faultpath.run.attempt import Done, attempt
from faultpath.run.check.blocks import BlockSpec, run_block
from faultpath.run.execution.recheck import deviation
from faultpath.run.plan import SystemSpec, Treatment
from faultpath.run.registry import load_system
from faultpath.run.store.signals import TOGETHER

SCENE, STEPS = ("selection/003",), 60


@pytest.mark.usefixtures("short")
def test_a_recorded_flight_is_the_flight_and_tells_why_errors_cancel() -> None:
    system = load_system(SystemSpec(name="quadrotor", options={"clearance": "true", "wind": "L3"}))
    wrong = fault("calibration=+0.1", system)
    faulted = at_readers(wrong, system.variants["dob"].readers)
    told: list[dict[str, np.ndarray]] = []
    for faults in ((), faulted):
        treatment = Treatment(variant="dob", faults=faults)
        run = run_block(system, BlockSpec(treatment, SCENE, signals=True))
        assert run.error == ""
        if faults:
            again = attempt(system, treatment, SCENE)
            assert isinstance(again, Done)
            assert deviation(again.outcomes, Done(run.outcomes, ())) is None
        told.append({each.name: each.values for each in run.signals[0]})
        trace = run.outcomes[0].trace
        assert trace is not None
        assert np.array_equal(told[-1]["vehicle.position"], trace[:-1])
    correct, wrong = told
    assert not correct["nominal acceleration error"].any()
    nominal = wrong["nominal acceleration error"].mean()
    assert nominal > 1.5
    combined = wrong["combined acceleration error"].mean()
    assert combined < 0.5 * nominal  # the reconstruction errs by the same, with the opposite sign
    first, second = "predictor: wrong mass and thrust", "reconstruction: wrong wind"
    for each in told:
        assert np.allclose(each[first] + each[second], each[TOGETHER], atol=1e-5)
        assert (np.abs(each[TOGETHER]) <= each["combined acceleration error"] + 1e-4).all()
    assert not correct[first].any()
    assert wrong[first].mean() < -1.5 < 1 < wrong[second].mean()
    assert np.allclose(wrong["mass at predictor.dynamics"], 1.1 * wrong["vehicle.mass"])
    assert (correct["commanded thrust"] > 0).all()
    predicted = correct["position predicted 1 s before"][20:]
    flown = correct["vehicle.position"]
    missed = np.linalg.norm(predicted - flown[20:], axis=1).mean()
    assert missed < 0.5 * np.linalg.norm(flown[20:] - flown[:-20], axis=1).mean()
