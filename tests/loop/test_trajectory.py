"""Hashes of trajectories: every bit that a reader got counts, and nothing else does."""

import numpy as np
import pytest

from faultpath.loop import Query
from faultpath.loop.trajectory import Trajectories

STEPS = [np.array([[0.1, 2.0], [3.0, 4.0], [5.0, 6.0]]) + step for step in range(5)]
RAN = [np.array([True, step < 3, step < 1]) for step in range(5)]


def hashes(steps=STEPS, ran=RAN, scenes=(0, 1, 2)):
    scenes = list(scenes)
    trajectories = Trajectories(len(scenes))
    for value, running in zip(steps, ran, strict=True):
        trajectories.set_running(running[scenes])
        trajectories.note(value[scenes])
    return trajectories.hashes()


def test_a_hash_does_not_depend_on_the_other_scenes_of_the_block():
    whole = hashes()
    assert len(set(whole)) == 3
    assert hashes(scenes=(2, 0)) == (whole[2], whole[0])


def test_a_scene_that_has_ended_adds_nothing():
    after = [np.where(ran[:, None], value, np.nan) for value, ran in zip(STEPS, RAN, strict=True)]
    assert hashes(after) == hashes()


@pytest.mark.parametrize("step", [0, 2])
def test_one_bit_of_one_scene_changes_its_hash_alone(step):
    steps = [value.copy() for value in STEPS]
    steps[step][0, 1] = np.nextafter(steps[step][0, 1], 9)
    same = [one == other for one, other in zip(hashes(steps), hashes(), strict=True)]
    assert same == [False, True, True]


def test_values_that_their_owner_writes_to_later_count_as_they_were():
    trajectories, value, ran = Trajectories(3), STEPS[0].copy(), RAN[0].copy()
    trajectories.set_running(ran)
    trajectories.note(value)
    value[:], ran[:] = 7, False
    assert trajectories.hashes() == hashes(STEPS[:1], RAN[:1])


def test_taking_in_early_changes_nothing(monkeypatch):
    whole = hashes()
    monkeypatch.setattr("faultpath.loop.trajectory._LARGEST_BUFFER", 1)
    assert hashes() == whole


def test_torch_and_numpy_have_the_same_bits():
    torch = pytest.importorskip("torch")
    assert hashes([torch.tensor(value) for value in STEPS]) == hashes()


def test_numbers_that_numpy_has_not_and_those_with_a_gradient_count_too():
    torch = pytest.importorskip("torch")
    steps = [torch.tensor(value, dtype=torch.bfloat16, requires_grad=True) for value in STEPS]
    whole = hashes(steps)
    with torch.no_grad():
        steps[4][0, 0] += 1
    same = [one == other for one, other in zip(hashes(steps), whole, strict=True)]
    assert same == [False, True, True]


def test_what_has_no_row_a_scene_is_left_out():
    trajectories = Trajectories(3)
    for value in (Query(lambda request: request), np.ones(2), np.float64(1), np.ones((3, 0))):
        trajectories.note(value)
    assert trajectories.hashes() == Trajectories(3).hashes()
