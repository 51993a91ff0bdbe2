"""Laws of every intervention behind a tap, on NumPy and on torch."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from libraries import to_torch
from tap_toys import INTERVENTIONS, make, play

from faultpath.faults import (
    Delay,
    Fault,
    Intervention,
    Noise,
    Offset,
    Scale,
    Sequence,
)
from faultpath.loop import Reading

SCENES = ("a", "b", "c", "d")
EACH = pytest.mark.parametrize("intervention", INTERVENTIONS, ids=lambda each: each.kind)
WINDOWS = pytest.mark.parametrize(
    "window",
    [{}, {"onset_step": 4, "duration_steps": 5, "recovery_steps": 3}],
    ids=["always", "window"],
)


def fault(intervention: Intervention, window: dict[str, Any], *readers: str) -> Fault:
    given = {"channel": "wind", "intervention": intervention} | window
    return Fault.model_validate(given).aimed_at(*readers)


@EACH
@WINDOWS
def test_json_round_trip_is_exact(intervention: Intervention, window: dict[str, Any]) -> None:
    alone = fault(intervention, window, "predictor").model_copy(update={"cause": "storm"})
    again = Fault.model_validate_json(alone.model_dump_json())
    assert again == alone
    assert hash(again) == hash(alone)


@EACH
@WINDOWS
def test_torch_gives_the_bits_of_numpy(intervention: Intervention, window: dict[str, Any]) -> None:
    faulted = fault(intervention, window)
    on_torch = play([faulted], SCENES, to=to_torch)
    assert on_torch.tobytes() == play([faulted], SCENES).tobytes()


@EACH
@WINDOWS
def test_a_scene_does_not_depend_on_its_neighbours(intervention, window):
    faulted = fault(intervention, window)
    block = play([faulted], SCENES, to=to_torch)
    for order in (("c", "a", "d", "b"), ("b", "d"), ("c",)):
        rows = [SCENES.index(scene) for scene in order]
        some = play([faulted], order, to=to_torch)
        assert some.tobytes() == np.ascontiguousarray(block[:, rows]).tobytes()


@EACH
@WINDOWS
def test_isolated_and_shared_agree_where_both_act(intervention, window):
    alone = play([fault(intervention, window, "predictor")], SCENES)
    shared = play([fault(intervention, window)], SCENES)
    elsewhere = play([fault(intervention, window, "planner")], SCENES)
    assert alone.tobytes() == shared.tobytes()
    assert elsewhere.tobytes() == play([], SCENES).tobytes() != alone.tobytes()


@EACH
def test_outside_the_window_the_reading_is_untouched(intervention: Intervention) -> None:
    window = {"onset_step": 4, "duration_steps": 5, "recovery_steps": 3}
    clean = play([], SCENES)
    values = play([fault(intervention, window)], SCENES)
    outside = [*range(4), *range(12, 16)]
    assert values[outside].tobytes() == clean[outside].tobytes()
    assert not np.array_equal(values[4:12], clean[4:12])


@EACH
@WINDOWS
def test_nothing_waits_for_a_device(intervention: Intervention, window: dict[str, Any]) -> None:
    """A meta tensor has no numbers: reading one back to the host raises."""
    import torch

    taps = make([fault(intervention, window)], SCENES)
    taps.set_active(torch.ones(4, dtype=torch.bool, device="meta"))
    for step in range(16):
        reading = Reading(torch.zeros(4, 3, device="meta"), "still", step)
        value = taps.deliver("wind", "predictor.wind", reading, step)
        assert value.device.type == "meta"
        assert value.shape == (4, 3)


@given(st.floats(-3, 3), st.floats(-3, 3), st.integers(0, 5), st.integers(1, 6), st.integers(0, 4))
@settings(max_examples=25, deadline=None)
def test_scales_in_turn_multiply(a: float, b: float, onset: int, last: int, back: int) -> None:
    window = {"onset_step": onset, "duration_steps": last, "recovery_steps": back}
    turn = fault(Sequence(parts=(Scale(factor=a), Scale(factor=b))), window)
    once = fault(Scale(factor=a * b), window)
    np.testing.assert_allclose(play([turn], "ab"), play([once], "ab"), rtol=1e-12, atol=1e-12)


def test_faults_that_meet_at_a_tap_act_in_order() -> None:
    double, shift = fault(Scale(factor=2.0), {}), fault(Offset(by=1.0), {"onset_step": 8})
    clean = play([], "ab")
    values = play([double, shift], "ab")
    np.testing.assert_array_equal(values[:8], clean[:8] * 2)
    np.testing.assert_array_equal(values[8:], clean[8:] * 2 + 1)
    np.testing.assert_array_equal(play([shift, double], "ab")[8:], (clean[8:] + 1) * 2)


@WINDOWS
def test_a_sequence_is_two_faults_with_one_window(window: dict[str, Any]) -> None:
    parts = (Scale(factor=2.0), Delay(steps=3))
    window = {key: value for key, value in window.items() if key != "recovery_steps"}
    apart = play([fault(part, window) for part in parts], SCENES)
    assert play([fault(Sequence(parts=parts), window)], SCENES).tobytes() == apart.tobytes()


def test_recovery_is_a_straight_line_back() -> None:
    window = {"onset_step": 2, "duration_steps": 3, "recovery_steps": 3}
    error = play([fault(Offset(by=1.0), window)], "ab") - play([], "ab")
    line = [0, 0, 1, 1, 1, 0.75, 0.5, 0.25, *[0] * 8]
    expected = np.broadcast_to(np.reshape(line, (16, 1, 1)), error.shape)
    np.testing.assert_allclose(error, expected, atol=1e-15)


def test_faults_of_one_cause_draw_the_same_numbers() -> None:
    noise = Noise(std=1.0)
    storm = [Fault(channel=c, intervention=noise, cause="storm") for c in ("mass", "wind")]

    def error(faults: list[Any], channel: str, reader: str) -> np.ndarray[Any, Any]:
        tap = {"channel": channel, "reader": reader}
        return play(faults, "ab", **tap) - play([], "ab", **tap)

    mass = error(storm, "mass", "observer.model")
    wind = error(storm, "wind", "predictor.wind")
    np.testing.assert_allclose(wind[..., 0], mass, atol=1e-12)
    alone = error([Fault(channel="mass", intervention=noise)], "mass", "observer.model")
    assert not np.any(np.isclose(alone, mass))
