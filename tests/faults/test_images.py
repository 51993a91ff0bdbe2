"""Faults of cameras."""

from typing import Any

import numpy as np
import pytest
import torch

from faultpath.faults import (
    Blur,
    Draws,
    Exposure,
    Intervention,
    Moment,
    Occlusion,
    SaltAndPepper,
    StuckRows,
)

SCENES = ("a", "b", "c")
KINDS = (
    Occlusion(share=0.25, shows=9.0),
    SaltAndPepper(probability=0.3),
    Blur(radius=1),
    Exposure(factor=3.0),
    StuckRows(share=0.5),
)
LIBRARIES = pytest.mark.parametrize("to", [np.asarray, torch.asarray], ids=["numpy", "torch"])
EACH = pytest.mark.parametrize("fault", KINDS, ids=[each.kind for each in KINDS])


def images(step: int, scenes: tuple[str, ...] = SCENES, shape: tuple[int, ...] = (8, 12)) -> Any:
    return np.stack(
        [
            np.random.default_rng([step, ord(scene)]).uniform(0.1, 0.9, shape).astype(np.float32)
            for scene in scenes
        ]
    )


def play(
    fault: Intervention,
    to: Any = np.asarray,
    scenes: tuple[str, ...] = SCENES,
    shape: tuple[int, ...] = (8, 12),
    onset: int = 0,
) -> np.ndarray[Any, Any]:
    """Return what is delivered in four steps, `[T, B, ...]`."""
    draws = Draws(scenes, 0, "cause")
    memory, values = None, []
    for step in range(4):
        reading, at = to(images(step, scenes, shape)), Moment(step, step - onset, 0.05, draws)
        memory = fault.begin(reading, at) if memory is None else memory
        value, memory = fault.apply(reading, memory, at)
        assert value.dtype == reading.dtype
        values.append(np.asarray(value).copy())
    return np.stack(values)


CLEAN = np.stack([images(step) for step in range(4)])


@EACH
def test_torch_gives_the_bits_of_numpy(fault: Intervention) -> None:
    assert play(fault, torch.asarray).tobytes() == play(fault).tobytes()


@EACH
def test_a_scene_does_not_depend_on_its_neighbours(fault: Intervention) -> None:
    assert play(fault, scenes=("c", "a")).tobytes() == play(fault)[:, [2, 0]].tobytes()


@EACH
def test_channels_of_a_scene_share_what_is_drawn(fault: Intervention) -> None:
    assert play(fault, shape=(2, 8, 12)).shape == (4, 3, 2, 8, 12)


@EACH
def test_nothing_waits_for_a_device(fault: Intervention) -> None:
    reading = torch.zeros(3, 8, 12, device="meta")
    at = Moment(0, torch.zeros(3, dtype=torch.int64, device="meta"), 0.05, Draws(SCENES, 0, "c"))
    value, _ = fault.apply(reading, fault.begin(reading, at), at)
    assert value.shape == reading.shape


def test_an_occlusion_covers_one_rectangle_that_stays() -> None:
    covered = play(KINDS[0]) == 9.0
    assert (covered == covered[0]).all()
    for mask in covered[0]:
        rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
        assert (len(rows), len(columns)) == (4, 6)  # half of each side
        assert mask[np.ix_(rows, columns)].all()
        assert mask.sum() == 24
    assert len({mask.tobytes() for mask in covered[0]}) > 1
    np.testing.assert_array_equal(play(KINDS[0])[~covered], CLEAN[~covered])


def test_salt_and_pepper_strike_alike_and_leave_the_rest() -> None:
    value = play(SaltAndPepper(probability=0.3, low=-1.0, high=2.0), shape=(80, 120))
    low, high = (value == -1.0).mean(), (value == 2.0).mean()
    assert low == pytest.approx(0.15, abs=0.01)
    assert high == pytest.approx(0.15, abs=0.01)
    clean = np.stack([images(step, shape=(80, 120)) for step in range(4)])
    others = (value != -1.0) & (value != 2.0)
    np.testing.assert_array_equal(value[others], clean[others])


def test_a_blur_is_the_mean_of_the_neighbours() -> None:
    wide = np.pad(CLEAN, ((0, 0), (0, 0), (1, 1), (1, 1)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(wide, (3, 3), axis=(2, 3))
    np.testing.assert_allclose(play(Blur(radius=1)), windows.mean((-2, -1)), rtol=1e-5)


def test_an_exposure_clips() -> None:
    np.testing.assert_allclose(play(Exposure(factor=3.0)), np.clip(CLEAN * 3, 0, 1), rtol=1e-6)


def test_stuck_rows_show_the_onset() -> None:
    value = play(StuckRows(share=0.5), onset=1)
    stuck = (value[3] == CLEAN[1]).all(-1)
    assert stuck.sum(1).tolist() == [4, 4, 4]
    assert ((value[3] == CLEAN[3]).all(-1) ^ stuck).all()
