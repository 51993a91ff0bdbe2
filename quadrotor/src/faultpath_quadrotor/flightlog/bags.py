"""Bags of ROS: numbers in fields of their messages, with their times."""

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.plugin.system import UserError, one_line, opened, unknown

Floats: TypeAlias = NDArray[np.float64]
SUFFIXES = (".mcap", ".db3", ".bag")
"""Endings of bags that are one file; others are folders with a metadata.yaml."""


def read_bag(
    path: Path, names: Iterable[str], time: tuple[str, float] | None
) -> dict[str, tuple[Floats, Floats]]:
    """Return times in s and values by name, each a topic, a dot and a field of its messages.

    `time` is the field of every message that holds its time, and how many seconds its unit is, 1
    for a stamp; `None`: when the bag recorded it. Raises `UserError` for what is no bag, a topic or
    field that it lacks, and where rosbags is not installed.
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
            return _series(path, bag, names, time)
    except UserError:
        raise
    except Exception as error:  # rosbags raises whatever a damaged file leads it into
        raise UserError(
            f"{path}: cannot be read as a bag ({why(error)}): give a whole recording of ROS with "
            "the definitions of its messages, which MCAP keeps: the folder with its metadata.yaml "
            "or one .mcap, .db3 or .bag file"
        ) from None


def _series(
    path: Path, bag: Any, names: Iterable[str], time: tuple[str, float] | None
) -> dict[str, tuple[Floats, Floats]]:
    by_topic: dict[str, list[str]] = {}
    for name in names:
        topic, _, field = name.partition(".")
        by_topic.setdefault(topic, []).append(field)
    series: dict[str, tuple[Floats, Floats]] = {}
    for topic, fields in by_topic.items():
        if topic not in bag.topics:
            raise UserError(f"{path}: {unknown('topic', topic, bag.topics)}")
        stamp = [time[0]] if time else []
        rows: list[list[float]] = []
        for connection, recorded_ns, raw in bag.messages(bag.topics[topic].connections):
            message = bag.deserialize(raw, connection.msgtype)
            try:
                numbers = [_number(message, field) for field in (*stamp, *fields)]
            except (AttributeError, LookupError, TypeError, ValueError) as error:
                raise UserError(
                    f"{path}: messages of topic '{topic}' ({connection.msgtype}) do not hold the "
                    f"numbers {', '.join([*stamp, *fields])} ({why(error)}): correct the map"
                ) from None
            rows.append(numbers if time else [recorded_ns * 1e-9, *numbers])
        times, *values = np.array(rows, np.float64).reshape(len(rows), 1 + len(fields)).T
        time_s = times * time[1] if time else times
        for field, column in zip(fields, values, strict=True):
            series[f"{topic}.{field}"] = time_s, column
    return series


def _number(message: Any, field: str) -> float:
    """Return the number in a field such as `pose.orientation.w` or `q[0]`; of a stamp seconds."""
    for part in re.findall(r"[^.\[\]]+", field):
        message = message[int(part)] if part.isdecimal() else getattr(message, part)
    return message.sec + message.nanosec * 1e-9 if hasattr(message, "sec") else float(message)


def why(error: Exception) -> str:
    """Return what an error says, in one line."""
    text = (error.strerror if isinstance(error, OSError) else "") or str(error)
    return one_line(text) or type(error).__name__
