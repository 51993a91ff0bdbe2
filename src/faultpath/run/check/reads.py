"""Log of who read what while a treatment runs, with digests that tell two runs apart."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from hashlib import blake2b
from typing import Any

import numpy as np
from typing_extensions import override

from faultpath.core.arrays import Array, to_numpy
from faultpath.loop import DeliveryListener, Query, Reading, Tap


class Enough(BaseException):
    """All steps that were asked for are recorded. No `Exception`: a system may catch those."""


@dataclass(slots=True)
class Read:
    """A delivery of one channel to one reader in one control step, to several scenes at once.

    It is noted while the trial runs, so it is a plain object: a validated one would cost more than
    the trial.
    """

    step: int
    channel: str
    reader: str
    source: str
    valid_step: int
    """Step of the reading: before `step` for what is late, held or read of the past; -1 is what
    the source held before the first step."""
    scenes: Sequence[str]
    requests: int = 0
    """Answers that the reader got of a query."""
    dtype: str = ""
    low: float = math.inf
    """Smallest of the finite numbers of all scenes."""
    high: float = -math.inf
    lost: str = ""
    """A scene with a number that is not finite."""
    clean: list[bytes] = field(default_factory=list[bytes])
    """By scene, a digest of what the source held."""
    got: list[bytes] = field(default_factory=list[bytes])
    """By scene, a digest of what the reader got."""
    sums: Any = ()
    """By scene, the sum of the finite numbers that the source held."""

    @property
    def tap(self) -> tuple[str, str]:
        """Channel and reader."""
        return self.channel, self.reader

    @property
    def altered(self) -> int:
        """Number of scenes in which the reader got something else than the source held."""
        return sum(clean != got for clean, got in zip(self.clean, self.got, strict=True))

    def take(self, value: Array, delivered: Array) -> None:
        """Take in a value and what the reader got of it."""
        self.dtype = str(value.dtype).removeprefix("torch.")
        clean, got = to_numpy(value), to_numpy(delivered)
        numbers = clean.astype(np.float64).reshape(len(clean), -1)
        finite = np.isfinite(numbers)
        if not finite.all():
            self.lost = self.scenes[int(np.flatnonzero(~finite.all(axis=1))[0])]
        self.low = float(np.min(numbers, initial=self.low, where=finite))
        self.high = float(np.max(numbers, initial=self.high, where=finite))
        total = np.where(finite, numbers, 0.0).sum(axis=1)
        self.sums = self.sums + total if len(self.sums) else total
        # A query has several answers in a step: each digest goes on from the one before.
        before = list(zip(self.clean, self.got, strict=True)) or [(b"", b"")] * len(clean)
        self.clean, self.got = [], []
        for (one, two), row, row_got in zip(before, clean, got, strict=False):
            content, content_got = one + row.tobytes(), two + row_got.tobytes()
            self.clean.append(_digest(content))
            alike = content == content_got
            self.got.append(self.clean[-1] if alike else _digest(content_got))


class ReadLog(DeliveryListener):
    """The deliveries of the taps of a run of some scenes.

    After `steps` control steps it raises `Enough`; `None`: never.
    """

    def __init__(self, scenes: Sequence[str], steps: int | None = None) -> None:
        self._scenes, self._steps = scenes, steps
        self._reads: dict[tuple[int, str, str], Read] = {}
        """By step, channel and reader, in the order in which they happened."""

    @override
    def delivered(self, tap: Tap, reading: Reading, step: int, got: Any) -> None:
        if self._steps is not None and step >= self._steps:
            raise Enough
        key = step, tap.channel, tap.reader
        if key in self._reads:
            return
        read = self._reads[key] = Read(*key, reading.source, reading.step, self._scenes)
        if not isinstance(reading.value, Query):
            tap.check_shape(reading.value)
            read.take(reading.value, got)

    @override
    def answered(
        self, tap: Tap, query: Query, step: int, request: Any, answer: Any, got: Any
    ) -> None:
        read = self._reads[step, tap.channel, tap.reader]
        read.requests += 1
        read.take(query.value(answer), query.value(got))

    def reads(self) -> tuple[Read, ...]:
        """Return all reads, in the order in which they happened."""
        return tuple(self._reads.values())


def _digest(content: bytes) -> bytes:
    return blake2b(content, digest_size=8).digest()
