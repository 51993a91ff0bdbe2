"""Bags of ROS as they lie in files: their topics, and the numbers in fields of their messages."""

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.plugin.system import UserError, one_line, opened, unknown

Floats: TypeAlias = NDArray[np.float64]
SUFFIXES = (".mcap", ".db3", ".bag")
"""Endings of bags that are one file; others are folders with a metadata.yaml."""
_TIMES = ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")
"""Seconds and nanoseconds that are one number."""


@contextmanager
def opened_bag(path: Path) -> Iterator[Any]:
    """Open a bag with rosbags' `AnyReader`.

    Raises `UserError` for what is no bag, also where that shows only while messages are read, and
    where rosbags is not installed.
    """
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise UserError(
            "reading bags of ROS needs rosbags, not installed here: in the checkout of faultpath, "
            "pip install './quadrotor[bags]'"
        ) from None
    try:
        for part in path.iterdir() if path.is_dir() else (path,):
            if part == path or not part.is_dir():
                opened(part, most=2**62).close()  # no pipe; messages are read one by one
        # Bags of ROS 2 before Iron keep no definitions; those of the common types never changed.
        with AnyReader([path], default_typestore=get_typestore(Stores.LATEST)) as bag:
            yield bag
    except UserError:
        raise
    except Exception as error:  # rosbags raises whatever a damaged file leads it into
        raise UserError(
            f"{path}: cannot be read as a bag ({why(error)}): give a whole recording of ROS, the "
            "folder with its metadata.yaml or one .mcap, .db3 or .bag file"
        ) from None


def check_fields(path: Path, bag: Any, topic: str, fields: Iterable[str]) -> None:
    """Raise `UserError` for a topic or field that is not there, and messages nobody can read."""
    if topic not in bag.topics:
        raise UserError(f"{path}: {unknown('topic', topic, bag.topics)}")
    kind = bag.topics[topic].msgtype
    if kind is None:
        raise UserError(f"{path}: topic '{topic}' has messages of several types: name another")
    try:
        known = tuple(_fields(bag.typestore.fielddefs, kind))
    except KeyError as error:
        raise UserError(
            f"{path}: topic '{topic}' holds messages of {kind}, and the bag says nothing of the "
            f"type {error}: record or convert it as MCAP, which keeps definitions"
        ) from None
    for field in fields:
        if re.sub(r"\[\d+\]", "[0]", field) not in known:
            raise UserError(f"{path}: topic '{topic}': {unknown('field', field, known)}")


def _fields(types: Any, kind: str) -> Iterator[str]:
    """Yield what holds numbers, as `pose.orientation.w`; of an array its first, as `q[0]`."""
    from rosbags.interfaces import Nodetype

    for name, (node, what) in types[kind][1]:
        if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            (node, what), name = what[0], f"{name}[0]"
        if node == Nodetype.NAME and what not in _TIMES:
            yield from (f"{name}.{field}" for field in _fields(types, what))
        elif node == Nodetype.NAME or "string" not in what[0]:
            yield name


def read_bag(
    path: Path, names: Iterable[str], time: tuple[str, float] | None
) -> dict[str, tuple[Floats, Floats]]:
    """Return times in s and values by name, each a topic, a dot and a field of its messages.

    `time` is the field of every message that holds its time, and how many seconds its unit is, 1
    for a stamp; `None`: when the bag recorded it. Raises `UserError` as `opened_bag` and
    `check_fields`.
    """
    by_topic: dict[str, list[str]] = {}
    for name in names:
        topic, _, field = name.partition(".")
        by_topic.setdefault(topic, []).append(field)
    series: dict[str, tuple[Floats, Floats]] = {}
    with opened_bag(path) as bag:
        for topic, fields in by_topic.items():
            check_fields(path, bag, topic, [*fields, time[0]] if time else fields)
        for topic, fields in by_topic.items():
            rows: list[list[float]] = []
            for connection, recorded_ns, raw in bag.messages(bag.topics[topic].connections):
                message = bag.deserialize(raw, connection.msgtype)
                when = _number(message, time[0]) * time[1] if time else recorded_ns * 1e-9
                rows.append([when, *(_number(message, field) for field in fields)])
            columns = np.array(rows, np.float64).reshape(len(rows), 1 + len(fields)).T
            for field, values in zip(fields, columns[1:], strict=True):
                series[f"{topic}.{field}"] = columns[0], values
    return series


def _number(message: Any, field: str) -> float:
    for part in field.split("."):
        name, _, place = part.removesuffix("]").partition("[")
        message = getattr(message, name)
        if place:
            message = message[int(place)]
    return message.sec + message.nanosec * 1e-9 if hasattr(message, "sec") else float(message)


def why(error: Exception) -> str:
    """Return what an error says, in one line."""
    text = (error.strerror if isinstance(error, OSError) else "") or str(error)
    return one_line(text) or type(error).__name__
