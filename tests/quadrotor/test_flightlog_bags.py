"""Bags of ROS: the flight in them, the maps of the page that are for them, and their mistakes."""

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
from flight_logs import MAP, flown, read, write

from faultpath.cli.main import main

pytest.importorskip("rosbags", reason="the quadrotor's extra bags is not installed")
from flight_bags import StoragePlugin, px4, ros, write_bag
from rosbags.convert import converter

COLUMNS = {name: values[::4] for name, values in flown().items()}
SHORT = {name: values[:200] for name, values in COLUMNS.items()}
PAGE = Path(__file__).resolve().parents[2] / "docs" / "recorded-flights.md"
_, PX4, MAVROS = re.findall(r"```yaml\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
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
    ("topics", "storage", "part", "text"),
    [
        (ros, StoragePlugin.SQLITE3, "", MAVROS),
        (ros, StoragePlugin.MCAP, "bag.mcap", MAVROS),
        (px4, StoragePlugin.MCAP, "", PX4),
    ],
)
def test_a_bag_and_the_map_of_the_page_hold_the_flight(
    tmp_path, known, topics, storage, part, text
):
    bag = write_bag(tmp_path / "bag", COLUMNS["t"], topics(COLUMNS), storage) / part
    result = compensation(read(bag, text))
    assert result.blocks == known.blocks
    for one, two in zip(result.combinations, known.combinations, strict=True):
        assert one.error_mps2.value == pytest.approx(two.error_mps2.value, rel=0.01)


def test_a_mistake_is_one_sentence_and_status_2(tmp_path: Path, short: Path, capsys: Any) -> None:
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
        (short, "linear.x", "linear.u", "has no attribute 'u'"),
        (short, ".thrust", ".header.frame_id", "could not convert string to float: 'map'"),
        (short, "attitude.thrust", "attitude", f"messages of topic '{ATTITUDE}' (mavros_msgs/msg"),
        (short, "header.stamp", "timestamp", "do not hold the numbers timestamp, pose"),
        (short, "linear.x", "linear.x[3]", "not subscriptable"),
        (short, "pose.pose.orientation.w", "pose.covariance[77]", "index 77 is out of bounds"),
        (humble, "", "", "mavros_msgs/msg/AttitudeTarget"),
        (back, "", "", "go back at its reading 150"),
    ):
        (tmp_path / "map.yaml").write_text(MAVROS.replace(old, new) if old else MAVROS)
        status, said = log(capsys, bag, "--columns", tmp_path / "map.yaml")
        assert (status, says in said) == (2, True), said
    (tmp_path / "map.yaml").write_text(MAVROS)
    with patch.dict(sys.modules, {"rosbags.highlevel": None}):
        assert (
            "pip install './quadrotor[bags]'"
            in log(capsys, short, "--columns", tmp_path / "map.yaml")[1]
        )


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
