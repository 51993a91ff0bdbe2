"""Observations of environments, nested or plain arrays, stacked into a batch or hashed."""

import re
from collections.abc import Mapping, Sequence
from hashlib import sha256
from typing import Any, cast

import numpy as np

from faultpath.core.arrays import HostArray

_PLACE = re.compile(r"faultpath_system_\w+\.| at 0x[0-9a-f]+")
"""The module of a system, called after where its file lies, and where in memory an object is."""


def stacked(rows: Sequence[Any]) -> Any:
    """Return observations of single scenes as that of a batch."""
    first = rows[0]
    if isinstance(first, Mapping):
        return {
            key: stacked([row[key] for row in rows]) for key in cast("Mapping[Any, Any]", first)
        }
    if isinstance(first, tuple):
        return tuple(stacked(column) for column in zip(*rows, strict=True))
    return np.stack(rows)


def hashed(*parts: Any) -> str:
    """Return a hash of arrays, numbers and what holds such, exact to the bit.

    Of another object, such as somebody's simulator, it counts that it is there.
    """

    def exact(part: Any) -> str:
        if isinstance(part, Mapping):
            items = cast("Mapping[Any, Any]", part).items()
            return str({str(key): exact(value) for key, value in items})
        if isinstance(part, tuple | list):
            return str([exact(element) for element in cast("Sequence[Any]", part)])
        if isinstance(part, np.ndarray | np.generic):
            array = cast("HostArray", part)
            return f"{array.dtype}{array.shape}{array.tobytes().hex()}"
        return _PLACE.sub("", repr(part))

    return sha256("\n".join(map(exact, parts)).encode()).hexdigest()
