"""Named signals of single trials as Parquet: one row for each component of a signal."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.core.files.parquet import INTEGER, NUMBERS, TEXT, Unreadable, decode, encode
from faultpath.run.store.tables import TrialAddress

SIGNALS = "signals.parquet"
"""The file in a run folder."""

IN_FORCE = "fault in force"
"""The signal that is 1 while a fault was in force at some tap."""

DRAWN = "drawn"
"""The signal that is a picture: a line through points in metres, `x` and `y` in turn."""

TOGETHER = "both together"
"""The signal that is the sum of the two others of its topic, the errors of two modules."""

_SCHEMA = {
    **dict.fromkeys(("variant", "condition"), TEXT),
    "seed": INTEGER,
    **dict.fromkeys(("scene", "signal", "topic", "unit"), TEXT),
    "component": INTEGER,
    "values": NUMBERS,
    "part": TEXT,
}


@dataclass(frozen=True)
class Signal:
    """Values that one name stood for over a trial."""

    name: str
    topic: str
    """Signals of one topic are drawn together."""
    unit: str
    values: NDArray[np.float32]
    """`[T, P]`: a row a control step from the first on, not a number where nothing was read."""
    parts: tuple[str, ...] = ()
    """Names of the components, where somebody named them."""


Signals: TypeAlias = Mapping[TrialAddress, tuple[Signal, ...]]


def encode_signals(signals: Signals) -> bytes:
    """Return the signals as a Parquet file."""
    rows = [
        {
            **address._asdict(),
            "signal": signal.name,
            "topic": signal.topic,
            "unit": signal.unit,
            "component": component,
            "part": signal.parts[component] if signal.parts else "",
            "values": np.ascontiguousarray(values, np.float32),
        }
        for address, named in signals.items()
        for signal in named
        for component, values in enumerate(signal.values.T)
    ]
    return encode(_SCHEMA, rows)


def decode_signals(data: bytes) -> dict[TrialAddress, tuple[Signal, ...]]:
    """Return the signals of a Parquet file; `Unreadable` when it holds none."""
    rows, _ = decode(data, _SCHEMA)
    trials: dict[TrialAddress, list[Signal]] = {}
    key = itemgetter("variant", "condition", "seed", "scene", "signal", "topic", "unit")
    for (*address, name, topic, unit), group in groupby(rows, key=key):
        parts = tuple(group)
        columns = [part["values"] for part in parts]
        if len({len(column) for column in columns}) != 1:
            raise Unreadable("the components of a signal differ in length")
        if any(np.isinf(column).any() for column in columns):
            raise Unreadable(f"the signal '{name}' is infinite")
        named = tuple(str(part["part"]) for part in parts if part["part"])
        signal = Signal(name, topic, unit, np.stack(columns, axis=1), named)
        trials.setdefault(TrialAddress(*address), []).append(signal)
    return {address: tuple(signals) for address, signals in trials.items()}
