"""Clocks that jitter and clocks that lose time."""

from typing import Any

import numpy as np
import pytest
import torch

from faultpath.faults import Draws, Intervention, Jitter, Moment, Skew

SCENES = tuple(f"scene-{i}" for i in range(300))
LIBRARIES = pytest.mark.parametrize("to", [np.asarray, torch.asarray], ids=["numpy", "torch"])


def ages(late: Intervention, steps: int, onset: Any, to: Any) -> np.ndarray[Any, Any]:
    """Return how many steps old the delivered readings are, `[T, B]`."""
    draws = Draws(SCENES, 0, "cause")
    memory, found = None, []
    for step in range(steps):
        at = Moment(step, step - onset, 0.05, draws)
        reading = to(np.full(len(SCENES), float(step)))
        memory = late.begin(reading, at) if memory is None else memory
        value, memory = late.apply(reading, memory, at)
        found.append(step - np.asarray(value))
    return np.stack(found)


@LIBRARIES
@pytest.mark.parametrize("own", [False, True])
def test_jitter_delays_by_up_to_its_steps_and_keeps_the_order(to: Any, own: bool) -> None:
    onset = to(np.full(len(SCENES), 4)) if own else 4
    age = ages(Jitter(steps=3), 40, onset, to)
    assert not age[:4].any()
    assert set(np.unique(age)) == {0, 1, 2, 3}
    assert (np.diff(np.arange(40)[:, None] - age, axis=0) >= 0).all()
    drawn = np.floor(Draws(SCENES, 0, "cause").uniform((), 4) * 4)
    assert (age[4] <= drawn).all()  # never older than drawn: what came before is not taken back
    assert age[10:].mean() > 0.5


@LIBRARIES
@pytest.mark.parametrize("own", [False, True])
def test_a_slow_clock_ages_its_readings_steadily(to: Any, own: bool) -> None:
    onset = to(np.full(len(SCENES), 4)) if own else 4
    age = ages(Skew(rate=0.25), 30, onset, to)
    expected = np.floor(0.25 * np.maximum(np.arange(30) - 4, 0))
    np.testing.assert_array_equal(age, np.tile(expected[:, None], len(SCENES)))


def test_a_long_run_keeps_no_more_than_it_needs() -> None:
    late, draws = Jitter(steps=3), Draws(("a",), 0, "cause")
    memory = late.begin(np.zeros(1), Moment(0, 0, 0.05, draws))
    for step in range(50):
        _, memory = late.apply(np.zeros(1), memory, Moment(step, step, 0.05, draws))
    assert len(memory[0]) <= 4
