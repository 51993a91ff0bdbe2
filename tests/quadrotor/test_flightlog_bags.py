"""Bags of ROS: the flight in them, the map that is proposed for them, and their mistakes."""

import re
import sqlite3
import sys
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
from faultpath_quadrotor.flightlog.bags import read_bag
from faultpath_quadrotor.flightlog.compensation import Compensation, compensation
from faultpath_quadrotor.flightlog.flight import read_flight
from faultpath_quadrotor.flightlog.proposing import propose
from faultpath_quadrotor.flightlog.reading import read_columns
from flight_logs import MAP, flown, read, write

from faultpath.cli.main import main
from faultpath.core.errors import UserError

pytest.importorskip("rosbags", reason="the quadrotor's extra bags is not installed")
from flight_bags import StoragePlugin, px4, ros, stamped, write_bag
from rosbags.convert import converter

COLUMNS = {name: values[::4] for name, values in flown().items()}
SHORT = {name: values[:200] for name, values in COLUMNS.items()}
ODOM, ATTITUDE = "/mavros/local_position/odom", "/mavros/setpoint_raw/attitude"


@pytest.fixture(scope="module")
def known(tmp_path_factory: pytest.TempPathFactory) -> Compensation:
    """The same flight in a table, without the drag, which no bag states."""
    text = MAP.replace("drag_kgps: [0.3, 0.3, 0.6]", "")
    text = text.replace("thrust}", "thrust, newton_per_unit: fit}")
    log = write(tmp_path_factory.mktemp("table") / "flight.csv", COLUMNS)
    return compensation(read(log, text))


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A few seconds in one MCAP file."""
    return write_bag(tmp_path_factory.mktemp("short") / "bag", SHORT["t"], ros(SHORT)) / "bag.mcap"


def log(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str]:
    """Return the status of `faultpath log` and what it says."""
    line = ["faultpath", "log", *map(str, arguments)]
    with patch.object(sys, "argv", line), pytest.raises(SystemExit) as ended:
        main()
    said = capsys.readouterr()
    assert "Traceback" not in said.err
    return int(str(ended.value)), " ".join((said.out + said.err).split())


@pytest.mark.parametrize(
    ("topics", "storage", "part", "time"),
    [
        (ros, StoragePlugin.SQLITE3, "", "header.stamp"),
        (ros, StoragePlugin.MCAP, "bag.mcap", "header.stamp"),
        (px4, StoragePlugin.MCAP, "", "timestamp"),
    ],
)
def test_a_bag_and_the_map_proposed_for_it_hold_the_flight(
    tmp_path, known, capsys, topics, storage, part, time
):
    bag = write_bag(tmp_path / "bag", COLUMNS["t"], topics(COLUMNS), storage) / part
    to = tmp_path / "columns.yaml"
    status, said = log(capsys, bag, "--propose", "--columns", to, "--mass", 1.5)
    assert status == 0
    assert f"Written: {to}" in said
    columns = read_columns(str(to))
    assert columns.time is not None
    assert columns.time.column == time
    result = compensation(read_flight(bag, columns))
    assert result.blocks == known.blocks
    for one, two in zip(result.combinations, known.combinations, strict=True):
        assert one.error_mps2.value == pytest.approx(two.error_mps2.value, rel=0.01)


def test_what_was_not_clear_is_said_in_the_map(tmp_path: Path) -> None:
    pose = {f"pose.orientation.{axis}": SHORT[f"q{axis}"] for axis in "wxyz"}
    velocity = {f"twist.linear.{axis}": SHORT[f"v{axis}"] for axis in "xyz"}
    topics: dict[str, Any] = {
        "/setpoint/pose": ("geometry_msgs/msg/PoseStamped", stamped(SHORT) | pose),
        "/vrpn/pose": ("geometry_msgs/msg/PoseStamped", stamped(SHORT) | pose),
        "/velocity": ("geometry_msgs/msg/TwistStamped", stamped(SHORT, "gate_7") | velocity),
    }
    # No thrust, a wish beside what was measured, and a frame that only a reader knows.
    text = propose(write_bag(tmp_path / "one", SHORT["t"], topics))
    assert "/vrpn/pose.pose.orientation.w" in text
    for said in ("/setpoint/pose (geometry", "gate_7", "Thrust was not found", "The mass is in no"):
        assert re.search(f"^# .*{re.escape(said)}", text, re.MULTILINE)
    (tmp_path / "map.yaml").write_text(text)
    with pytest.raises(UserError, match="thrust: is missing"):
        read_columns(str(tmp_path / "map.yaml"))
    # With stamps that go back, and with the two conventions of axes in one bag.
    thrust = ros(SHORT)[ATTITUDE]
    thrust[1]["header.stamp.sec"] = thrust[1]["header.stamp.sec"][::-1]
    topics |= {ATTITUDE: thrust, "/odometry": px4(SHORT)["/fmu/out/vehicle_odometry"]}
    text = propose(write_bag(tmp_path / "two", SHORT["t"], topics))
    assert "\ntime:" not in text
    assert "\nframe: ENU" in text
    assert re.search("^# .*/odometry", text, re.MULTILINE)
    nothing = {"/h": ("std_msgs/msg/Header", {"frame_id": "map"})}
    with pytest.raises(UserError, match=r"no topic has a type .* only std_msgs/msg/Header"):
        propose(write_bag(tmp_path / "none", SHORT["t"], nothing))


def test_a_mistake_is_one_sentence_and_status_2(tmp_path: Path, short: Path, capsys: Any) -> None:
    good = propose(short, 1.5)
    text, cut, empty = tmp_path / "text.db3", tmp_path / "cut.mcap", tmp_path / "empty"
    text.write_text("no bag")
    cut.write_bytes(short.read_bytes()[: short.stat().st_size // 2])
    empty.mkdir()
    # As ROS 2 Humble writes it, without definitions; those of the common types are known.
    humble = write_bag(tmp_path / "humble", SHORT["t"], ros(SHORT), StoragePlugin.SQLITE3)
    with sqlite3.connect(humble / "humble.db3") as base:
        base.execute("DELETE FROM message_definitions")
    assert len(read_bag(humble, [f"{ODOM}.pose.covariance[35]"], ("header.stamp", 1.0))) == 1
    topics = ros(SHORT)
    topics[ATTITUDE][1]["header.stamp.sec"][150] = 990
    back = write_bag(tmp_path / "back", SHORT["t"], topics)
    for bag, old, new, says in (
        (text, "", "", "cannot be read as a bag"),
        (empty, "", "", "metadata"),
        (tmp_path / "none.mcap", "", "", "No such file"),
        (cut, "", "", "cannot be read as a bag"),
        (short, "_position/odom", "_position/odem", f"did you mean '{ODOM}'?"),
        (short, "linear.x", "linear.u", "unknown field 'twist.twist.linear.u'"),
        (short, ".thrust", ".header.frame_id", "unknown field 'header.frame_id'"),
        (short, ".thrust", "", "unknown field ''"),
        (short, "header.stamp", "timestamp", "unknown field 'timestamp'"),
        (short, "linear.x", "linear.x[3]", "unknown field 'twist.twist.linear.x[3]'"),
        (short, "pose.pose.orientation.w", "pose.covariance[77]", "index 77 is out of bounds"),
        (humble, "", "", "says nothing of the type 'mavros_msgs/msg/AttitudeTarget'"),
        (back, "", "", "go back at its reading 150"),
    ):
        (tmp_path / "map.yaml").write_text(good.replace(old, new) if old else good)
        status, said = log(capsys, bag, "--columns", tmp_path / "map.yaml")
        assert (status, says in said) == (2, True), said
    for line, says in (
        ([short], "--columns is missing"),
        ([short, "--propose", "--json"], "--json would do nothing with --propose"),
        ([short, "--propose", "--columns", tmp_path / "map.yaml"], "is there already"),
        ([tmp_path / "map.yaml", "--propose", "--columns", "x"], "give a bag of ROS"),
    ):
        status, said = log(capsys, *line)
        assert (status, says in said) == (2, True), said
    with patch.dict(sys.modules, {"rosbags.highlevel": None}):
        assert "pip install './quadrotor[bags]'" in log(capsys, short, "--propose")[1]


def test_times_of_the_recording_need_no_stamps(tmp_path: Path, short: Path) -> None:
    name = f"{ODOM}.pose.pose.orientation.w"
    recorded, values = read_bag(short, [name], None)[name]
    assert (np.abs(recorded - 1000 - SHORT["t"] - 0.01) <= 0.01 + 1e-6).all()
    assert np.array_equal(values, SHORT["qw"])
    # A bag of ROS 1 holds the same.
    options = ("", 0, None, "", None, None, (), (), (), ())
    converter.convert([short], tmp_path / "one.bag", *options)
    again = read_bag(tmp_path / "one.bag", [name], None)[name]
    assert np.array_equal(again, (recorded, values))
