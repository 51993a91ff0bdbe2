"""What the flight viewer shows, small enough for a page: numbers as text that its script unpacks.

Whole numbers become second differences, which are near zero along a flight, laid out by bytes and
deflated. Nothing is lost: what is rounded was rounded before.
"""

import json
import zlib
from base64 import b64decode, b64encode
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Whole: TypeAlias = NDArray[np.int32]

_LENGTHS = "lengths"


def pack(content: Mapping[str, Any], series: Sequence[Whole]) -> str:
    """Return `content`, which is JSON, and series of whole numbers as base64.

    Whatever in `content` is a place in `series` finds it there again when unpacked.
    """
    head = {**content, _LENGTHS: [len(each) for each in series]}
    text = json.dumps(head, separators=(",", ":"), allow_nan=False).encode()
    steps = [_differences(_differences(each.astype(np.uint32))) for each in series]
    joined = np.concatenate(steps) if steps else np.empty(0, np.uint32)
    planes = joined.astype("<u4").view(np.uint8).reshape(-1, 4).T.tobytes()
    return b64encode(zlib.compress(len(text).to_bytes(4, "little") + text + planes, 9)).decode()


def unpack(packed: str) -> tuple[dict[str, Any], list[Whole]]:
    """Return the content and the series of what `pack` made."""
    plain = zlib.decompress(b64decode(packed))
    end = 4 + int.from_bytes(plain[:4], "little")
    head: dict[str, Any] = json.loads(plain[4:end])
    lengths: list[int] = head.pop(_LENGTHS)
    planes = np.frombuffer(plain[end:], np.uint8).reshape(4, -1)
    steps = np.ascontiguousarray(planes.T).view("<u4").ravel()
    parts = np.split(steps, np.cumsum(lengths)[:-1]) if lengths else []
    twice = (np.cumsum(np.cumsum(part, dtype=np.uint32), dtype=np.uint32) for part in parts)
    return head, [each.view(np.int32) for each in twice]


def _differences(values: NDArray[np.uint32]) -> NDArray[np.uint32]:
    return np.diff(values, prepend=np.zeros(1, np.uint32))
