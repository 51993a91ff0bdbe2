"""A map of columns proposed from the types of a bag's topics, and what was not clear about it."""

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from faultpath.plugin.system import UserError, listed, one_line
from faultpath_quadrotor.flightlog.bags import SUFFIXES, check_fields, opened_bag, read_bag

_WISHES = ("setpoint", "target", "reference", "desired", "goal", "command", "cmd")
"""In names of topics that say where a vehicle is to be, not where it is."""
_WORLD = (
    "A twist does not say along whose axes it is: the world's are taken, and its first message "
    "names the frame '{first.header.frame_id}'. Write axes: body if they are the vehicle's."
)
_CHILD = (
    "The twist of an Odometry is in its child frame, here '{first.child_frame_id}', taken for the "
    "body's. Write axes: world if it is along the world's."
)
_IMU = "Many drivers leave the orientation of an Imu empty: look whether it is there."
_SIGHT = "velocity_frame must be NED in its messages: write axes: body if it is BODY_FRD."
_NORMALISED = "It is taken for normalised: write newton_per_unit: 1 if it is in N."
_FIT = "newton_per_unit: fit"
# Best first: type, field of each component, what else the map says, and what the type leaves open.
_TYPES = {
    "attitude": (
        ("px4_msgs/msg/VehicleAttitude", "q[{}]", "order: wxyz", ""),
        ("px4_msgs/msg/VehicleOdometry", "q[{}]", "order: wxyz", ""),
        ("nav_msgs/msg/Odometry", "pose.pose.orientation.{}", "order: wxyz", ""),
        ("geometry_msgs/msg/PoseStamped", "pose.orientation.{}", "order: wxyz", ""),
        ("sensor_msgs/msg/Imu", "orientation.{}", "order: wxyz", _IMU),
    ),
    "velocity": (
        ("px4_msgs/msg/VehicleLocalPosition", "v{}", "axes: world", ""),
        ("px4_msgs/msg/VehicleOdometry", "velocity[{}]", "axes: world", _SIGHT),
        ("nav_msgs/msg/Odometry", "twist.twist.linear.{}", "axes: body", _CHILD),
        ("geometry_msgs/msg/TwistStamped", "twist.linear.{}", "axes: world", _WORLD),
    ),
    "thrust": (
        ("px4_msgs/msg/VehicleThrustSetpoint", "xyz[2]", _FIT, ""),
        ("px4_msgs/msg/VehicleAttitudeSetpoint", "thrust_body[2]", _FIT, ""),
        ("mavros_msgs/msg/AttitudeTarget", "thrust", _FIT, _NORMALISED),
        ("mavros_msgs/msg/Thrust", "thrust", _FIT, _NORMALISED),
    ),
}
_COMPONENTS = {"attitude": ("wxyz", "0123"), "velocity": ("xyz", "012"), "thrust": ("-", "-")}


class _Candidate(NamedTuple):
    """A topic that holds what is looked for."""

    topic: str
    messages: int
    type: str
    fields: tuple[str, ...]
    more: str
    note: str

    @property
    def names(self) -> list[str]:
        return [f"{self.topic}.{field}" for field in self.fields]

    @property
    def frame(self) -> str:
        return "NED" if self.type.startswith("px4_msgs/") else "ENU"

    def __str__(self) -> str:
        return f"{self.topic} ({self.type}, {self.messages} messages)"


def propose(path: Path, mass_kg: float | None = None) -> str:
    """Return the map that the types of a bag's topics suggest, as YAML.

    What is missing is left out; comments say so, and all that was not clear. Attitude and velocity
    are taken in one frame. Raises `UserError` for what is no bag, and where nothing is found.
    """
    if not path.is_dir() and path.suffix.lower() not in SUFFIXES:
        raise UserError(
            f"{path}: --propose reads the types of a bag's messages: give a bag of ROS, and for "
            "others --columns px4 or a map as in docs/recorded-flights.md"
        )
    lines = [f"Proposed from the types of the topics in {json.dumps(path.name)}: check it."]
    parts: dict[str, str] = {}
    with opened_bag(path) as bag:
        candidates = {what: _search(path, bag, what, lines) for what in _TYPES}
        motion = [candidates["attitude"], candidates["velocity"]]
        frames = [{topic.frame for topic in topics} for topics in motion]
        frame = max(("ENU", "NED"), key=lambda name: sum(name in known for known in frames))
        chosen: list[_Candidate] = []
        for what, topics in candidates.items():
            fitting = [topic for topic in topics if what == "thrust" or topic.frame == frame]
            if not fitting:
                types = ", ".join(kind for kind, *_ in _TYPES[what])
                lines.append(f"{what.capitalize()} was not found in {frame}; looked for {types}.")
                continue
            best = fitting[0]
            chosen.append(best)
            lines.append(f"{what.capitalize()} is that of {best}.")
            if others := [str(topic) for topic in topics if topic != best]:
                lines.append(f"{' and '.join(others)} has it too: which is right, no bag says.")
            if best.note:
                connection, _, raw = next(bag.messages(bag.topics[best.topic].connections))
                first = bag.deserialize(raw, connection.msgtype)
                lines.append(best.note.format(first=first))
            columns = json.dumps(best.names if what != "thrust" else best.names[0])
            parts[what] = f"{{column{'s' * (what != 'thrust')}: {columns}, {best.more}}}"
        if not chosen:
            kinds = {str(info.msgtype) for info in bag.topics.values()}
            raise UserError(
                f"{path}: no topic has a type known to hold attitude, velocity or thrust, only "
                f"{listed(kinds)}: write the map as in docs/recorded-flights.md"
            )
    if field := _clock(path, [name for topic in chosen for name in topic.names]):
        parts["time"] = f"{{column: {field[0]}, unit: {field[1]}}}"
    else:
        lines.append(
            "Times are those of the recording, late by what the transport took: the topics have no "
            "stamps that are set, ascend and overlap."
        )
    lines.append(f"The axes are taken for {frame}, as {'PX4' if frame == 'NED' else 'ROS'} does.")
    parts["frame"] = frame
    if mass_kg is None:
        lines.append("The mass is in no bag: write mass_kg here, or give --mass.")
    else:
        parts["mass_kg"] = str(mass_kg)
    comments = [f"# {one_line(line)}" for line in lines]
    return "\n".join([*comments, *(f"{key}: {value}" for key, value in parts.items()), ""])


def _search(path: Path, bag: Any, what: str, lines: list[str]) -> list[_Candidate]:
    """Return topics that hold something, the best first; `lines` gets why others cannot be read."""
    candidates: list[_Candidate] = []
    for kind, field, more, note in _TYPES[what]:
        fields = tuple(dict.fromkeys(map(field.format, _COMPONENTS[what]["[" in field])))
        for topic, info in bag.topics.items():
            if info.msgtype == kind and info.msgcount:
                try:
                    check_fields(path, bag, topic, fields)
                    candidates.append(_Candidate(topic, info.msgcount, kind, fields, more, note))
                except UserError as error:
                    lines.append(f"{error}.")
    return sorted(candidates, key=lambda one: any(wish in one.topic for wish in _WISHES))


def _clock(path: Path, names: list[str]) -> tuple[str, str] | None:
    """Return the field that holds the time of all these messages, and its unit, if one does."""
    for field, unit, scale in (("header.stamp", "s", 1.0), ("timestamp", "us", 1e-6)):
        try:
            times = [time_s for time_s, _ in read_bag(path, names, (field, scale)).values()]
        except UserError:  # not all of them have it
            continue
        ascends = all(time_s[0] > 0 and (np.diff(time_s) >= 0).all() for time_s in times)
        if ascends and max(time_s[0] for time_s in times) < min(time_s[-1] for time_s in times):
            return field, unit
    return None
