"""Signals as MCAP, the file that Foxglove, rerun and PlotJuggler play.

Messages are those of ROS 2: their definition stands in the file, and any reader of bags reads them.
"""

import re
from io import BytesIO

from faultpath.core.errors import UserError
from faultpath.core.text import extra
from faultpath.trials.store.signals import Signal, Signals

_LITTLE_ENDIAN = b"\x00\x01\x00\x00"
"""The head of a message in CDR."""


def encode_mcap(signals: Signals, dt_s: float) -> bytes:
    """Return signals as an MCAP file: a topic for each signal of each trial.

    A topic is `/VARIANT/PATH/seed_N/SCENE/SIGNAL`, with `gain@controller/inverse` for `gain at
    controller.inverse`; its metadata hold these names as they are, and the unit. Control step k
    lies at k `dt_s`. Raises `UserError` where the package mcap is not installed.
    """
    try:
        from mcap.writer import Writer
    except ImportError:
        raise UserError(
            f"writing MCAP files needs the package mcap, not installed here: {extra('mcap')}"
        ) from None
    writer = Writer(file := BytesIO())
    writer.start(profile="ros2", library="faultpath")
    schemas: dict[str, int] = {}
    rows: list[tuple[int, int, bytes]] = []
    for address, named in signals.items():
        for each in named:
            definition = "".join(f"float32 {field}  # {each.unit}\n" for field in _fields(each))
            if definition not in schemas:
                name = f"faultpath_msgs/msg/Signal{len(schemas) + 1}"
                schemas[definition] = writer.register_schema(name, "ros2msg", definition.encode())
            variant, path, seed, scene = map(str, address)
            parts = ("", variant, path, f"seed_{seed}", scene, each.name.replace(" at ", "@"))
            topic = re.sub(r"[^\w@/+-]+", "_", "/".join(parts).replace(".", "/"))
            told = {"variant": variant, "path": path, "seed": seed, "scene": scene}
            told |= {"signal": each.name, "topic": each.topic, "unit": each.unit}
            channel = writer.register_channel(topic, "cdr", schemas[definition], told)
            for step, values in enumerate(each.values.astype("<f4")):
                rows.append((step, channel, _LITTLE_ENDIAN + values.tobytes()))
    for step, channel, data in sorted(rows):  # players read in the order of time
        at_ns = round(step * dt_s * 1e9)
        writer.add_message(channel, at_ns, data, at_ns, step)
    writer.finish()
    return file.getvalue()


def _fields(signal: Signal) -> list[str]:
    """Return the names of components as ROS takes them, in lower case; numbers where not."""
    count = signal.values.shape[1]
    words = [re.sub("[^a-z0-9]+", "_", part.lower()).strip("_") for part in signal.parts]
    if len(set(words)) == count and all(re.match("[a-z]", word) for word in words):
        return words
    return ["value"] if count == 1 else [f"component_{place}" for place in range(1, count + 1)]
