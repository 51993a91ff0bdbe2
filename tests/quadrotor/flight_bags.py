"""Bags of ROS that hold the made-up flight, written by rosbags with messages of real types."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from scipy.spatial.transform import Rotation

STORE = get_typestore(Stores.ROS2_HUMBLE)
DEFINITIONS = {
    "mavros_msgs/msg/AttitudeTarget": "std_msgs/Header header\nuint8 type_mask\n"
    "geometry_msgs/Quaternion orientation\ngeometry_msgs/Vector3 body_rate\nfloat32 thrust\n",
    "px4_msgs/msg/VehicleOdometry": "uint64 timestamp\nuint64 timestamp_sample\nuint8 pose_frame\n"
    "float32[3] position\nfloat32[4] q\nuint8 velocity_frame\nfloat32[3] velocity\n"
    "float32[3] angular_velocity\nfloat32[3] position_variance\nfloat32[3] orientation_variance\n"
    "float32[3] velocity_variance\nuint8 reset_counter\nint8 quality\n",
    "px4_msgs/msg/VehicleThrustSetpoint": "uint64 timestamp\nuint64 timestamp_sample\n"
    "float32[3] xyz\n",
}
for name, definition in DEFINITIONS.items():
    STORE.register(get_types_from_msg(definition, name))

Topics = Mapping[str, tuple[str, Mapping[str, Any]]]
"""By topic: the type of its messages, and by field a value or an array `[N]`."""
FULL_N = 30.0


def stamped(columns: Mapping[str, Any], frame: str = "map") -> dict[str, Any]:
    """Return the fields of a header whose stamps count from 1000 s."""
    sec, nanosec = np.divmod(np.round(columns["t"] * 1e9).astype(int) + 10**12, 10**9)
    return {"header.stamp.sec": sec, "header.stamp.nanosec": nanosec, "header.frame_id": frame}


def ros(columns: Mapping[str, Any]) -> dict[str, Any]:
    """Return the flight as mavros tells it: twists in the body's axes, normalised thrust."""
    turned = Rotation.from_quat(np.stack([columns[f"q{axis}"] for axis in "xyzw"], axis=1))
    body = turned.inv().apply(np.stack([columns[f"v{axis}"] for axis in "xyz"], axis=1))
    odometry = stamped(columns) | {"child_frame_id": "base_link"}
    odometry |= {f"pose.pose.orientation.{axis}": columns[f"q{axis}"] for axis in "wxyz"}
    odometry |= {f"twist.twist.linear.{axis}": body[:, i] for i, axis in enumerate("xyz")}
    return {
        "/mavros/local_position/odom": ("nav_msgs/msg/Odometry", odometry),
        "/mavros/setpoint_raw/attitude": (
            "mavros_msgs/msg/AttitudeTarget",
            stamped(columns) | {"thrust": columns["thrust"] / FULL_N},
        ),
    }


def px4(columns: Mapping[str, Any]) -> dict[str, Any]:
    """Return the flight as PX4 tells it to ROS 2: axes that point down, and times in us."""
    flip = {"w": 1, "x": 1, "y": -1, "z": -1}
    stamp = {"timestamp": np.round(columns["t"] * 1e6).astype(int) + 1}
    odometry = {f"q[{i}]": flip[axis] * columns[f"q{axis}"] for i, axis in enumerate("wxyz")}
    odometry |= {f"velocity[{i}]": flip[axis] * columns[f"v{axis}"] for i, axis in enumerate("xyz")}
    thrust = stamp | {"xyz[2]": -columns["thrust"] / FULL_N}
    return {
        "/fmu/out/vehicle_odometry": ("px4_msgs/msg/VehicleOdometry", stamp | odometry),
        "/fmu/out/vehicle_thrust_setpoint": ("px4_msgs/msg/VehicleThrustSetpoint", thrust),
    }


def write_bag(
    path: Path, times_s: Any, topics: Topics, storage: StoragePlugin = StoragePlugin.MCAP
) -> Path:
    """Write a bag that records each message up to 20 ms after its time."""
    late_ns = np.sort(np.random.default_rng(0).integers(0, 20_000_000, len(times_s)))
    with Writer(path, version=9, storage_plugin=storage) as bag:
        for topic, (kind, fields) in topics.items():
            connection, message = bag.add_connection(topic, kind, typestore=STORE), _blank(kind)
            for row, when in enumerate(times_s):
                for field, values in fields.items():
                    _put(message, field, values[row].item() if hasattr(values, "item") else values)
                recorded_ns = 10**12 + round(when * 1e9) + int(late_ns[row])
                bag.write(connection, recorded_ns, STORE.serialize_cdr(message, kind))
    return path


def _blank(kind: str) -> Any:
    def value(node: Any, what: Any) -> Any:
        if node == Nodetype.NAME:
            return _blank(what)
        if node == Nodetype.BASE:
            return "" if what[0] == "string" else 0
        return np.zeros(what[1], what[0][1][0])

    return STORE.types[kind](**{name: value(*of) for name, of in STORE.fielddefs[kind][1]})


def _put(message: Any, field: str, value: Any) -> None:
    *inside, last = field.removesuffix("]").replace("[", ".").split(".")
    for part in inside:
        message = getattr(message, part)
    if last.isdecimal():
        message[int(last)] = value
    else:
        setattr(message, last, value)
