"""Linear axes with round tick marks."""

import math
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Axis:
    """Maps data from `low..high` to pixels from `start` to `end`."""

    low: float
    high: float
    start: float
    end: float

    def __call__(self, value: float) -> float:
        """Return the pixel of a value."""
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    def ticks(self, about: int = 5) -> list[float]:
        """Return round numbers inside the axis, roughly `about` of them."""
        step = _round_step((self.high - self.low) / max(about, 1))
        first = math.ceil(self.low / step - 1e-9)
        last = math.floor(self.high / step + 1e-9)
        return [i * step for i in range(first, last + 1)]

    def at(self, start: float, end: float) -> "Axis":
        """Return the same data range over other pixels."""
        return Axis(self.low, self.high, start, end)


def covering(values: Iterable[float], margin: float = 0.06, least: float = 1.0) -> Axis:
    """Return an axis from 0 to 1 pixel that covers 0 and every value, with a margin."""
    inside = [0.0, *values]
    low, high = min(inside), max(inside)
    if high - low < least:
        middle = 0.5 * (low + high)
        low, high = middle - 0.5 * least, middle + 0.5 * least
    pad = margin * (high - low)
    return Axis(low - pad, high + pad, 0.0, 1.0)


def tick_label(value: float) -> str:
    """Return a short label with a real minus sign."""
    return f"{value:g}".replace("-", "−")


def _round_step(raw: float) -> float:
    power = 10.0 ** math.floor(math.log10(raw))
    return power * next(m for m in (1.0, 2.0, 5.0, 10.0) if raw <= m * power * 1.0001)
