"""Recorded errors arrive by scene, seed and step; vectors are turned as a mount turns them."""

from pathlib import Path

import numpy as np
import pytest
from fault_toys import INTERFACE
from scipy.spatial.transform import Rotation

from faultpath.core.errors import UserError
from faultpath.faults import (
    Address,
    Draws,
    Moment,
    Recorded,
    Rotate,
    encode_record,
    parse_fault,
)
from faultpath.interface import Channel

SCENES = ("a", "b")
TURNED = Rotation.from_rotvec([[0.1, 0.0, 0.2], [0.3, 0.0, 0.0]]).as_matrix().astype("f4")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    record = {
        Address("wind", "a", 0): np.arange(6, dtype="f4").reshape(2, 3),
        Address("wind", "b", 0): np.full((4, 3), 9, "f4"),
        **{Address("attitude", scene, 0): TURNED for scene in SCENES},
    }
    path = tmp_path / "errors.parquet"
    path.write_bytes(encode_record(record, ("attitude",)))
    return path


def at(step: int, seed: int = 0) -> Moment:
    return Moment(step, step, 0.05, Draws(SCENES, seed, "cause"))


def resolved(file: Path, channel: str) -> Recorded:
    return Recorded(file=str(file)).resolved(
        Channel(name=channel, sources=("it",), readers=("planner.start",))
    )


def test_each_scene_gets_its_own_errors_and_keeps_the_last(file: Path) -> None:
    doing, reading = resolved(file, "wind"), np.ones((2, 3))
    memory = doing.begin(reading, at(0))
    first, _ = doing.apply(reading, memory, at(0))
    later, _ = doing.apply(reading, memory, at(3))
    assert (first == [[1, 2, 3], [10, 10, 10]]).all()
    assert (later == [[4, 5, 6], [10, 10, 10]]).all()


def test_errors_of_rotations_turn_the_reading_in_its_axes(file: Path) -> None:
    doing = resolved(file, "attitude")
    reading = np.stack([Rotation.from_euler("z", angle).as_matrix() for angle in (1.0, 2.0)])
    value, _ = doing.apply(reading, doing.begin(reading, at(0)), at(1))
    assert np.allclose(value, reading @ TURNED[1].astype("f8"), atol=1e-12)


def test_a_vector_turns_about_the_axis_by_the_angle() -> None:
    by, reading = (0.3, -0.2, 0.5), np.arange(30.0).reshape(2, 5, 3)
    value, _ = Rotate(by=by).apply(reading, None, at(0))
    turned = Rotation.from_rotvec(by).apply(reading.reshape(-1, 3)).reshape(reading.shape)
    assert np.allclose(value, turned, atol=1e-12)
    assert Rotate(by=(0.0, 0.0, 0.0)).apply(reading, None, at(0))[0] is reading


def test_trials_belong_to_what_the_file_held(file: Path) -> None:
    before = resolved(file, "wind")
    file.write_bytes(encode_record({Address("wind", scene, 0): TURNED[:, 0] for scene in SCENES}))
    assert resolved(file, "wind").digest != before.digest
    for act in (
        lambda: before.resolved(INTERFACE.channel("wind")),
        lambda: before.begin(np.ones((2, 3)), at(0)),
    ):
        with pytest.raises(UserError, match="record the errors again"):
            act()


def test_what_cannot_be_delivered_is_said(file: Path, tmp_path: Path) -> None:
    with pytest.raises(UserError, match="holds no errors of channel 'mass'"):
        parse_fault(f"mass:recorded={file}", INTERFACE, {}, 0.05)
    assert parse_fault(f"wind:recorded={file}@predictor", INTERFACE, {}, 0.05)
    with pytest.raises(UserError, match="cannot be read"):
        parse_fault("wind:recorded=none.parquet", INTERFACE, {}, 0.05)
    odd = tmp_path / "odd.parquet"
    odd.write_bytes(b"no table")
    with pytest.raises(UserError, match="is no record of errors"):
        resolved(odd, "wind")
    doing = resolved(file, "wind")
    with pytest.raises(UserError, match="scene 'a', seed 7: record that scene too"):
        doing.begin(np.ones((2, 3)), at(0, seed=7))
    with pytest.raises(UserError, match=r"no errors like \[2\]"):
        doing.begin(np.ones((2, 2)), at(0))
