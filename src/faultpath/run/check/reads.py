"""Log of who read what while a treatment runs, with digests that tell two runs apart."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import blake2b
from typing import Any

import numpy as np
from pydantic import Field
from typing_extensions import override

from faultpath.core.arrays import HostArray, to_numpy
from faultpath.core.results import Result
from faultpath.loop import DeliveryListener, Query, Reading, Tap


class Enough(BaseException):
    """All steps that were asked for are recorded. No `Exception`: a system may catch those."""


class Read(Result):
    """A delivery of one channel to one reader in one control step."""

    step: int
    reader: str
    channel: str
    source: str
    valid_step: int
    """Step of the reading: before `step` for what is late, held or read of the past; -1 is what
    the source held before the first step."""
    asks: int = 0
    """Answers that the reader got of a query."""
    altered_by: tuple[str, ...] = ()
    """Faults at the tap, where what was delivered differs from the reading."""
    dtype: str = Field(default="", exclude=True)
    low: float = Field(default=math.inf, exclude=True)
    high: float = Field(default=-math.inf, exclude=True)
    """Largest of the finite numbers of all scenes, as `low` is the smallest."""
    lost: str = Field(default="", exclude=True)
    """A scene with a number that is not finite."""
    clean: Mapping[str, bytes] = Field(default={}, exclude=True)
    """A digest of what the source held, by scene."""
    sums: Mapping[str, float] = Field(default={}, exclude=True)
    """Sum of the finite numbers that the source held, by scene."""
    got: Mapping[str, bytes] = Field(default={}, exclude=True)
    """A digest of what the reader got, by scene."""

    @property
    def tap(self) -> tuple[str, str]:
        """Channel and reader."""
        return self.channel, self.reader

    @property
    def altered(self) -> int:
        """Number of scenes in which the reader got something else than the source held."""
        return sum(self.clean[scene] != self.got[scene] for scene in self.clean)


class ReadLog(DeliveryListener):
    """The deliveries of the taps of a run of some scenes.

    After `steps` control steps it raises `Enough`; `None`: never.
    """

    def __init__(self, scenes: Sequence[str], steps: int | None = None) -> None:
        self._scenes, self._steps = scenes, steps
        self._noted: dict[tuple[int, str, str], _Noted] = {}
        """By step, channel and reader, in the order in which they happened."""

    @override
    def delivered(self, tap: Tap, reading: Reading, step: int, got: Any) -> None:
        if self._steps is not None and step >= self._steps:
            raise Enough
        key = step, tap.channel, tap.reader
        if key in self._noted:
            return
        noted = self._noted[key] = _Noted(reading.source, reading.step)
        if not isinstance(reading.value, Query):
            tap.check_shape(reading.value)
            noted.take(to_numpy(reading.value), to_numpy(got))

    @override
    def answered(
        self, tap: Tap, query: Query, step: int, request: Any, answer: Any, got: Any
    ) -> None:
        noted = self._noted[step, tap.channel, tap.reader]
        noted.asks += 1
        noted.take(to_numpy(query.value(answer)), to_numpy(query.value(got)))

    def reads(self) -> tuple[Read, ...]:
        """Return all reads, in the order in which they happened."""
        return tuple(noted.read(key, self._scenes) for key, noted in self._noted.items())


@dataclass(slots=True)
class _Noted:
    """One delivery under way. To make a `Read` of it at once would cost more than the trial."""

    source: str
    valid_step: int
    asks: int = 0
    dtype: str = ""
    low: float = math.inf
    high: float = -math.inf
    lost: int | None = None
    """Row of a scene with a number that is not finite."""
    clean: list[bytes] = field(default_factory=list[bytes])
    """Digest by row of what the source held, as `got` is of what the reader got."""
    got: list[bytes] = field(default_factory=list[bytes])
    sums: Any = None
    """Sum by row of the finite numbers that the source held."""

    def take(self, clean: HostArray, got: HostArray) -> None:
        """Take in a value and what the reader got of it."""
        self.dtype = str(clean.dtype)
        numbers = clean.astype(np.float64).reshape(len(clean), -1)
        finite = np.isfinite(numbers)
        if not finite.all():
            self.lost = int(np.flatnonzero(~finite.all(axis=1))[0])
        self.low = float(np.min(numbers, initial=self.low, where=finite))
        self.high = float(np.max(numbers, initial=self.high, where=finite))
        total = np.where(finite, numbers, 0.0).sum(axis=1)
        self.sums = total if self.sums is None else self.sums + total
        before = list(zip(self.clean, self.got, strict=True)) or [(b"", b"")] * len(clean)
        self.clean, self.got = [], []
        for (one, other), row, received in zip(before, clean, got, strict=False):
            content, content_got = one + row.tobytes(), other + received.tobytes()
            self.clean.append(_digest(content))
            alike = content == content_got
            self.got.append(self.clean[-1] if alike else _digest(content_got))

    def read(self, key: tuple[int, str, str], scenes: Sequence[str]) -> Read:
        """Return it as part of a result. Its fields are of our own making and need no check."""
        step, channel, reader = key
        return Read.model_construct(
            step=step,
            reader=reader,
            channel=channel,
            source=self.source,
            valid_step=self.valid_step,
            asks=self.asks,
            altered_by=(),
            dtype=self.dtype,
            low=self.low,
            high=self.high,
            lost="" if self.lost is None else scenes[self.lost],
            clean=dict(zip(scenes, self.clean, strict=False)),
            sums={} if self.sums is None else dict(zip(scenes, self.sums.tolist(), strict=False)),
            got=dict(zip(scenes, self.got, strict=False)),
        )


def _digest(content: bytes) -> bytes:
    return blake2b(content, digest_size=8).digest()
