"""An outcome that is not what it should be makes its trial failed, and says why."""

import math
from dataclasses import replace

import numpy as np
import pytest

from faultpath.system import Outcome, Status
from faultpath.system.outcome import checked, failed_outcome

GOOD = Outcome("a", Status.SUCCESS, 2.0, "i", "d", "none", {"rms_m": 0.5})


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"status": "success"}, "status is 'success': give a faultpath.system.Status"),
        ({"time_s": math.nan}, "time_s is nan"),
        ({"time_s": "2"}, "time_s is '2': give a number"),
        ({"time_s": True}, "time_s is True"),
        ({"time_s": 10**400}, "time_s is"),
        ({"time_s": 0.0}, "time_s is 0.0: a trial takes at least one control step"),
        ({"metrics": {"rms_m": math.inf}}, "rms_m is inf"),
        ({"metrics": {"rms_m": -1e308}}, "rms_m is -1e+308: give a finite number of at most 1e"),
        ({"metrics": {"rms_m": np.zeros(1)}}, "rms_m is"),
        ({"metrics": {"rms": 1.0}}, "metric 'rms' is not declared: name it in"),
        ({"initial_hash": ""}, "initial_hash is empty"),
        ({"disturbance_hash": None}, "disturbance_hash is None: give text"),
        ({"planner_noise_hash": "\ud800"}, "planner_noise_hash"),
        ({"trace": np.zeros((4, 2))}, "trace has the shape [4, 2], not [steps, 3]"),
        ({"trace": [[0.0, 0.0, math.nan]]}, "trace is not finite at step 0"),
        ({"trace": [["a", "b", "c"]]}, "trace is no array of numbers"),
        ({"trace": [[0.0], [0.0, 1.0]]}, "trace is no array of numbers"),
    ],
)
def test_a_malformed_outcome_is_a_failed_trial(fields, said):
    failed = checked(replace(GOOD, **fields), ("rms_m",))
    assert failed.failed
    assert failed.scene == "a"
    assert said in failed.error
    assert failed.error.startswith("malformed outcome: ")
    assert (failed.metrics, failed.trace) == ({}, None)


@pytest.mark.parametrize(
    "fields",
    [
        {},
        {"time_s": np.float32(2.0)},
        {"time_s": 2},
        {"metrics": {"rms_m": np.float64(0.25)}},
        {"metrics": {}},
        {"trace": np.zeros((0, 3), np.float32)},
        {"trace": np.ones((4, 3))},
        {"status": Status.FAILED, "time_s": math.nan, "error": "said by the system"},
    ],
)
def test_a_sound_one_stays_what_it_is(fields):
    given = replace(GOOD, **fields)
    outcome = checked(given, ("rms_m",))
    assert outcome.status is given.status
    assert type(outcome.time_s) is float
    if given.trace is not None:
        np.testing.assert_array_equal(outcome.trace, given.trace)
        assert outcome.trace.dtype == np.float32
    if given.failed:
        assert outcome.error == "said by the system"
    else:
        assert outcome.metrics == given.metrics


def test_a_failed_trial_always_says_why():
    assert checked(replace(GOOD, status=Status.FAILED)).error == "the system said that it failed"


@pytest.mark.parametrize("dt_s", [0.01, 0.02, 0.05, 0.1, 1 / 3])
def test_a_time_tells_the_steps_that_it_is_the_sum_of(dt_s):
    for count in range(1, 400):
        for time_s in (count * dt_s, sum([dt_s] * count)):
            assert Outcome("a", Status.SUCCESS, time_s, "i", "d", "n").steps(dt_s) == count
    assert failed_outcome("a", "why").steps(dt_s) == 0
