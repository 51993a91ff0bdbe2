"""When a source is fresh: its rate and its latency, executed."""

import math
from collections import deque
from typing import Any

from faultpath.interface import Source
from faultpath.taps import Reading

_SLACK = 1e-6
"""Of a step: what rounding of rates and latencies may take away."""


class Clock:
    """Turns what a source holds at every step into what has arrived of it.

    A source of `rate_hz` is sampled at the first control step at or after each of its ticks, and
    held in between. Its sample arrives `latency_s` later, rounded up to whole steps; until one has
    arrived, the first sample stands in. A reading says of which step it is.
    """

    def __init__(self, source: Source, dt_s: float) -> None:
        self._name = source.name
        ticks = (source.rate_hz or math.inf) * dt_s
        self._ticks = None if ticks >= 1 - _SLACK else ticks
        self._late = math.ceil(source.latency_s / dt_s - _SLACK)
        self._turn = -1
        self._under_way: deque[Reading] = deque()

    def read(self, value: Any, step: int) -> Reading:
        """Return the reading that has arrived at `step`, whose value at the source is `value`."""
        turn = step if self._ticks is None else math.floor(step * self._ticks + _SLACK)
        if turn != self._turn:
            self._turn = turn
            self._under_way.append(Reading(value, self._name, step))
        waiting = self._under_way
        while len(waiting) > 1 and waiting[1].step + self._late <= step:
            waiting.popleft()
        return waiting[0]
