"""How a trial ends, in scenes whose end does not depend on the planner."""

from pathlib import Path

import numpy as np
import pytest
from faultpath_quadrotor.plant.module import GOAL_RADIUS_M
from faultpath_quadrotor.scenes.scene import Box
from faultpath_quadrotor.vehicle import COLLISION_RADIUS_M, CONTROL_DT_S, GRAVITY_MPS2
from flights import HELD_OUT, STEPS, fault, fly, hall, quadrotor, trace, with_halls

from faultpath.system import Outcome, Status

HOVER = f"action:erase={GRAVITY_MPS2}/0/0/0@vehicle"
FALL = "action:erase=0/0/0/0@vehicle"
TABLE = Box(centre_m=(0.0, 0.0, 0.5), half_extents_m=(0.5, 0.5, 0.5))
pytestmark = pytest.mark.usefixtures("short")


def _end(tmp_path: Path, text: str, *args) -> Outcome:
    system = quadrotor()
    scenes = with_halls(system, tmp_path, hall(0, *args))
    return fly(system, "zero-wind", scenes, fault(text, system))[0][0]


def test_arrival_is_a_success_at_the_end_of_a_control_step(tmp_path):
    end = _end(tmp_path, FALL, (0.0, 0.0, 1.5), (0.0, 0.0, 0.997))
    assert end.status is Status.SUCCESS
    assert end.time_s == CONTROL_DT_S
    assert end.metrics["terminal_distance_m"] <= GOAL_RADIUS_M
    assert trace(end).shape == (2, 3)


def test_hovering_till_the_end_is_a_timeout(tmp_path):
    end = _end(tmp_path, HOVER, (-3.0, 0.0, 1.5), (3.0, 0.0, 1.5))
    assert end.status is Status.TIMEOUT
    assert end.time_s == pytest.approx(STEPS * CONTROL_DT_S)
    assert end.metrics["terminal_distance_m"] == pytest.approx(6.0, abs=1e-6)
    assert end.metrics["min_clearance_m"] == pytest.approx(1.5 - COLLISION_RADIUS_M, abs=1e-6)
    assert trace(end).shape == (STEPS + 1, 3)
    assert np.abs(trace(end) - trace(end)[0]).max() < 1e-6


@pytest.mark.parametrize(
    ("height_m", "boxes", "drop_m"),
    [(0.8, (), 0.6), (1.6, (TABLE,), 0.4)],
    ids=["floor", "obstacle"],
)
def test_falling_onto_something_is_a_crash_when_physics_says_so(tmp_path, height_m, boxes, drop_m):
    end = _end(tmp_path, FALL, (0.0, 0.0, height_m), (4.0, 0.0, 1.5), boxes)
    free_fall_s = (2 * drop_m / GRAVITY_MPS2) ** 0.5
    assert end.status is Status.CRASH
    # The motors first have to stop: two lags of 40 ms delay the fall, drag hardly.
    assert free_fall_s + 0.02 < end.time_s < free_fall_s + 0.1
    assert end.time_s / 0.01 == pytest.approx(round(end.time_s / 0.01))
    assert -0.05 < end.metrics["min_clearance_m"] <= 0


def test_terminal_distance_and_clearance_are_those_of_the_trace():
    system = quadrotor(wind="L2")
    outcomes, _ = fly(system, "zero-wind", HELD_OUT)
    for outcome in outcomes:
        scene = system.scene(outcome.scene)
        path = trace(outcome)
        assert path.dtype == np.float32
        assert path[0] == pytest.approx(scene.start_m, abs=1e-6)
        missed = np.linalg.norm(path[-1] - np.array(scene.goal_m))
        assert outcome.metrics["terminal_distance_m"] == pytest.approx(missed, abs=1e-5)
        assert len(path) == round(outcome.time_s / CONTROL_DT_S) + 1
        low, high = np.array(scene.bounds.low_m), np.array(scene.bounds.high_m)
        walls = min((path - low).min(), (high - path).min()) - COLLISION_RADIUS_M
        assert outcome.metrics["min_clearance_m"] <= walls + 1e-5
        assert outcome.metrics["min_clearance_m"] > 0
