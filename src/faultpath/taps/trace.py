"""Who read what, when: the interface as it ran."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from hashlib import blake2b
from typing import Any

import numpy as np
from typing_extensions import override

from faultpath.arrays import HostArray, to_numpy
from faultpath.taps.errors import IllegalRead, UndeclaredReader
from faultpath.taps.reading import Query, Reading
from faultpath.taps.tap import Tap
from faultpath.taps.taps import Taps


class TraceEnded(BaseException):
    """Enough was seen. No `Exception`: the code of a system may catch those."""


@dataclass(frozen=True)
class Read:
    """What one consumer got of one channel in one control step."""

    step: int
    channel: str
    consumer: str
    source: str
    valid_step: int
    """Step of the reading: before `step` for what is late, held or read of the past."""
    dtype: str = ""
    shape: tuple[int, ...] = ()
    """Of one scene's reading, or of one scene in an answer."""
    low: float = np.inf
    high: float = -np.inf
    """Of the finite numbers of all scenes."""
    lost: tuple[int, ...] = ()
    """Rows of the scenes with a number that is not finite."""
    asks: int = 0
    """Answers that the consumer got of a query."""
    given: tuple[bytes, ...] = ()
    """A digest of what the source held, one a scene."""
    got: tuple[bytes, ...] = ()
    """A digest of what the consumer got, one a scene."""
    sums: tuple[tuple[float, float], ...] = ()
    """A weighted sum of what the source held and the sum of its sizes, one pair a scene: by these
    two readings that are not the same to the bit are told apart by how much."""
    used: bool | None = None
    """Whether the module looked at it; `None` where no loop of ours runs that could tell."""

    @property
    def tap(self) -> tuple[str, str]:
        """Channel and consumer."""
        return self.channel, self.consumer

    @property
    def altered(self) -> bool:
        """Whether a fault changed it, in some scene."""
        return self.given != self.got


@dataclass
class Trace:
    """The reads of the first steps of a run, in the order in which they happened."""

    steps: int | None = 3
    """`None`: all."""
    refused: dict[tuple[str, str], str] = field(default_factory=dict[tuple[str, str], str])
    """Reads that taps refuse, with their sentence: by nobody declared, privileged, of the future,
    of another source. A traced run lets them pass, so that it shows the rest too."""
    truths: set[tuple[str, str]] = field(default_factory=set[tuple[str, str]])
    """Module and the plant's truth that it took past all taps."""
    held: dict[tuple[int, str, str], Read] = field(
        default_factory=dict[tuple[int, str, str], Read], repr=False
    )

    @property
    def reads(self) -> tuple[Read, ...]:
        """What was read."""
        return tuple(self.held.values())

    def unused(self) -> Iterator[tuple[str, str]]:
        """Yield channel and consumer of ports at which the module never looked."""
        seen: dict[tuple[str, str], bool] = {}
        for read in self.reads:
            seen[read.tap] = seen.get(read.tap, False) or read.used is not False
        yield from (tap for tap, used in seen.items() if not used)


class TracedTaps(Taps):
    """Taps that take down in `trace` what passes, and stop the run after its steps.

    The other arguments are those of `Taps`. What is delivered is the same to the bit.
    """

    traced = True

    def __init__(self, *given: Any, trace: Trace, **named: Any) -> None:
        super().__init__(*given, **named)
        self._trace = trace

    def deliver(self, channel: str, consumer: str, reading: Reading, step: int) -> Any:
        """Deliver as `Taps` does, but let a read pass that is against the declarations.

        Raises `TraceEnded` at the first delivery after the steps of the trace.
        """
        trace = self._trace
        if trace.steps is not None and step >= trace.steps:
            raise TraceEnded
        try:
            got = super().deliver(channel, consumer, reading, step)
        except (UndeclaredReader, IllegalRead) as error:
            trace.refused.setdefault((channel, consumer), str(error))
            got = reading.value.answer if isinstance(reading.value, Query) else reading.value
        key = step, channel, consumer
        if key not in trace.held:
            read = Read(step, channel, consumer, reading.source, reading.step)
            signal = not isinstance(reading.value, Query)
            trace.held[key] = _noted(read, reading.value, got) if signal else read
        return got

    @override
    def looked(
        self,
        step: int,
        looks: Mapping[tuple[str, str], bool],
        truths: Collection[tuple[str, str]],
    ) -> None:
        self._trace.truths |= set(truths)
        for (channel, consumer), used in looks.items():
            key = step, channel, consumer
            self._trace.held[key] = replace(self._trace.held[key], used=used)

    @override
    def _answer(self, tap: Tap, query: Query, step: int, request: Any) -> Any:
        made: list[Any] = []

        def noting(asked: Any) -> Any:
            made.append(query.answer(asked))
            return made[0]

        got = super()._answer(tap, replace(query, answer=noting), step, request)
        key = step, tap.channel, tap.consumer
        read = self._trace.held[key]
        read = replace(read, asks=read.asks + 1)
        self._trace.held[key] = _noted(read, query.value(made[0]), query.value(got))
        return got


def _noted(read: Read, given: Any, got: Any) -> Read:
    values = to_numpy(given)
    finite = np.isfinite(values)
    seen = values[finite]
    lost = ~finite.reshape(len(values), -1).all(axis=1)
    digests = _digests(values)
    return replace(
        read,
        dtype=str(values.dtype),
        shape=tuple(values.shape[1:]),
        low=min(read.low, float(seen.min())) if seen.size else read.low,
        high=max(read.high, float(seen.max())) if seen.size else read.high,
        lost=tuple(np.flatnonzero(lost).tolist()) or read.lost,
        given=_added(read.given, digests),
        sums=_sums(values, read.sums),
        got=_added(read.got, _digests(to_numpy(got))),
    )


def _sums(
    values: HostArray, before: tuple[tuple[float, float], ...]
) -> tuple[tuple[float, float], ...]:
    rows = np.nan_to_num(values.reshape(len(values), -1).astype(float), posinf=0.0, neginf=0.0)
    now = zip(rows @ _weights(rows.shape[1]), np.abs(rows).sum(axis=1), strict=True)
    pairs = zip(before or [(0.0, 0.0)] * len(rows), now, strict=True)
    return tuple((float(a + c), float(b + d)) for (a, b), (c, d) in pairs)


def _weights(count: int) -> HostArray:
    return 0.5 + 0.5 * np.modf(np.arange(count) * 0.6180339887498949)[0]


def _digests(values: HostArray) -> tuple[bytes, ...]:
    return tuple(_digest(row.tobytes()) for row in values)


def _added(before: tuple[bytes, ...], now: tuple[bytes, ...]) -> tuple[bytes, ...]:
    pairs = zip(before, now, strict=True)
    return tuple(_digest(one + other) for one, other in pairs) if before else now


def _digest(content: bytes) -> bytes:
    return blake2b(content, digest_size=8).digest()
